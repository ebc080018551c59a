import time,sys
import numpy as np
from fingertip.design import Design
from fingertip.lab.campaign import closed_loop as cl
from fingertip.sim.runs import grip
from fingertip.slip.detectors import fast_decision as fd
d=Design.load(sys.argv[1])
plans=list(cl.plan_manipulations(1,cl.FIRST_SEED))
for scene,seed in plans[:2]:
    t=time.process_time(); res,dec=cl._close_loop(d,scene=scene.model_copy(update={'outputs':cl._OUTPUTS}),detector='fast',seed=seed); print('cpu',time.process_time()-t)
    ts=[x.time_s for x in dec if x.tightened]; print(len(ts),np.round(ts[:20],3)); 
    slip=res.slip if hasattr(res,'slip') else None
    for f in res.fingers[:3]:
        tr=res.trace(f)
        from fingertip.slip.traces.truth import intervals
        print(f,[(round(i.onset_s,3),round(i.end_s,3)) for i in intervals(tr.time_s,tr.slip)][:5], tr.voltage_v[[0,1000,2000,4000,-1]])
        from fingertip.slip.detectors.registry import make_detector,select_inputs
        odds=[]; orig=fd.FastDecision._judge
        def spy(self,o): odds.append((self.ticks*self_tick,round(float(o),1))); orig(self,o)
        self_tick=.002
        fd.FastDecision._judge=spy
        o=make_detector('fast',d).process(*select_inputs(tr,'fast')); fd.FastDecision._judge=orig
        on=np.flatnonzero(np.diff(o.on.astype(int),prepend=0)); print('   on',np.round(tr.time_s[on][:12],3), 'thr mV',o.threshold_v[[700,2000,4000,-1]]*1e3, odds[:5])
