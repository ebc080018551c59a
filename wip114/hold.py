import sys; sys.path.insert(0,'/tmp/w/chain')
import numpy as np, data
from fingertip.slip.detectors.fast import *
from fingertip.slip.detectors.fast_settings import *
from fingertip.slip.detectors import fast_decision as fd
sig=[s for s in data.get('joinedT')]
trials=data.get('trialsT')[::3]
for u in (0.1,0.16,0.3,0.5,1e3):
    fd.UNHEARD_S=u; r={}
    for s in sig+trials:
        st=FastSettings(s.rate_hz,max(1e-12,1e-3*np.std(s.x)),filtered=FilteredSignal(1.0,1e9) if s.s is not None else None)
        o=FastDetector(st).process(s.x,s.s)
        for m,on_,e in s.slips:
            r.setdefault(s.kind if s.kind!='trial' else 'trial '+s.design,[]).append(o.on[round(on_*s.rate_hz):round(e*s.rate_hz)].mean())
    print(u,{k:round(float(np.mean(v)),4) for k,v in r.items()},flush=True)
