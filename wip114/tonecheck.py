import sys; sys.path.insert(0,'/tmp/w/chain')
import numpy as np, data
from fingertip.slip.detectors.fast import *
from fingertip.slip.detectors.fast_settings import *
from fingertip.slip.detectors import fast_decision as fd
n=0
orig=fd.FastDecision._end_tone
def spy(self,s,e):
    global n
    was=self.on; orig(self,s,e)
    n+= was and not self.on
fd.FastDecision._end_tone=spy
for k in ('joinedT','stageJ','trialsT','burstsT','mixPT','gen2001'):
    n=0; c=0;dur=0
    for s in data.get(k)[:100] if k!='gen2001' else data.get(k)[::7]:
        st=FastSettings(s.rate_hz,max(1e-12,1e-3*np.std(s.x)),filtered=FilteredSignal(1.0,1e9) if s.s is not None else None)
        o=FastDetector(st).process(s.x,s.s); c+=o.on.sum()/s.rate_hz; dur+=len(s.x)/s.rate_hz
    print(k,'tones',n,'in ON s',c,'of',dur)
