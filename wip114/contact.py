import numpy as np
from fingertip.design import Design
from fingertip.lab.campaign import closed_loop as cl
from fingertip.slip.detectors import fast_decision as fd
from fingertip.slip.detectors.registry import make_detector,select_inputs
d=Design.load('first_finger')
plans=list(cl.plan_manipulations(1,cl.FIRST_SEED))
scene,seed=plans[0]
res,dec=cl._close_loop(d,scene=scene.model_copy(update={'outputs':cl._OUTPUTS}),detector='fast',seed=seed)
np.savez('/tmp/w/contact.npz',**{f:res.trace(f).voltage_v for f in res.fingers[:3]},**{f+'_n':res.trace(f).slip for f in res.fingers[:3]})
tr=res.trace('index')
odds=[]; orig=fd.FastDecision._judge
def spy(self,o): odds.append((self.ticks*.002,round(float(o),1),self.on)); orig(self,o)
fd.FastDecision._judge=spy
o=make_detector('fast',d).process(*select_inputs(tr,'fast'))
v=tr.voltage_v
for a in np.arange(1.0,2.6,.05):
    i=slice(int(a*2000),int((a+.05)*2000)); print(round(a,2), np.round(v[i][[0,-1]],3), 'stat mV',round(o.statistic_v[i].mean()*1e3,3), 'on',o.on[i].mean(), [x for x in odds if a<=x[0]<a+.05][::4][:6])
