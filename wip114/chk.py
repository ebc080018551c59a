import numpy as np, time
from fingertip.design import Design
from fingertip.slip.detectors.fast import *
from fingertip.slip.detectors.registry import make_detector
d=Design.load("fsr400"); a=Design.load("article")
rng=np.random.default_rng(1)
def rest(n,noise=5e-4,step=0): 
    x=2.0+noise*rng.standard_normal(n)
    return np.round(x/step)*step if step else x
# chunks
x=rest(8000); x[4000:6000]+=0.01*rng.standard_normal(2000)
D1=FastDetector.for_design(a); o=D1.process(x)
print('on',o.on.mean(), np.flatnonzero(o.on)[[0,-1]]/2000)
D2=FastDetector.for_design(a); parts=np.split(x,[1,7,100,101,5000,5001])
q=[D2.process(p) for p in parts]
print('chunks', all(np.array_equal(np.concatenate([getattr(p,k) for p in q]),getattr(o,k)) for k in vars(o)))
D3=FastDetector.for_design(a); t=time.perf_counter(); s=[D3.step(v) for v in x]; print('step us',(time.perf_counter()-t)/len(x)*1e6, np.array_equal(s,o.on))
# glitches
n=0;inc=0
for k in range(60):
    x=rest(6000); x[3000]+=rng.choice([-1,1])*10**rng.uniform(-2.5,0)
    o=FastDetector.for_design(a).process(x); n+=o.on.any(); inc+=o.incipient.any()
print('glitch on',n,'inc',inc)
# steps 
for step in (0.8e-3,3.2e-3,10e-3,20e-3):
  for noise in (1e-5,2e-4,5e-4,2e-3):
    on=0;inc=0
    for k in range(6):
        t=np.arange(12000)/2000; x=2-0.5*np.clip((t-2)/rng.uniform(.1,1),0,1)+noise*rng.standard_normal(len(t))
        x=np.round(x/step)*step
        o=FastDetector.for_design(a).process(x); on+=o.on.any(); inc+=o.incipient.any()
    print('coarse',step,noise,on,inc)
# standing still
x=rest(20000); x[6000:14000]=x[6000]; o=FastDetector.for_design(a).process(x); print('stuck', o.on.any(), o.incipient.any())
x=rest(20000); x[:8000]=x[0]; o=FastDetector.for_design(a).process(x); print('stuck at start', o.on.any(), o.incipient.any())
x=rest(20000); x[6000:6300]=np.nan; x[9000]=np.inf; o=FastDetector.for_design(a).process(x); print('gap', o.on.any(), o.incipient.any(), o.is_replaced.mean())
x=rest(20000); x[6000:12000]=0; o=FastDetector.for_design(a).process(x); print('drop to 0 and back', o.on.mean(), o.incipient.mean())
x=rest(40000,5e-4); x[20000:]=rest(20000,2e-3); o=FastDetector.for_design(a).process(x); print('noise x4', o.on.mean(), o.incipient.mean())
x=rest(40000,2e-3); x[20000:]=rest(20000,5e-4); o=FastDetector.for_design(a).process(x); print('noise /4', o.on.mean(), o.incipient.mean(), o.threshold_v[[19999,22000,-1]])
for hz in (50,100,120,180): 
    t=np.arange(40000)/2000; x=rest(40000); x+= (t>8)*0.01*np.sin(2*np.pi*hz*t); o=FastDetector.for_design(a).process(x); print('tone',hz, o.on.mean(), o.incipient.mean())
