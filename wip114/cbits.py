import ctypes, subprocess, sys, tempfile, numpy as np
from pathlib import Path
from dataclasses import replace
from fingertip.design import Design
from fingertip.firmware.c_sources import library_sources, library_settings
from fingertip.firmware.fingers import Fingers
from fingertip.slip.detectors.fast import FastDetector
def build(d, f):
    for n,b in library_sources(d,Fingers()).items(): (f/n).write_bytes(b)
    (f/'probe.c').write_text('''
#include "slip_detector.h"
void run(const float*t,const float*s,int n,unsigned char*flags,float*odds,float*floor_,float*mean,float*vib){
 static slip_state st; slip_init(&st);
 for(int i=0;i<n;i++){ s?slip_step(&st,t[i],s[i]):slip_step_tactile(&st,t[i]);
  flags[i]=(st.on?1:0)|(slip_is_incipient(&st)?2:0)|((slip_faults(&st)&3u)<<2); odds[i]=st.odds; floor_[i]=st.floor; mean[i]=st.mean; vib[i]=st.vibration;}
}
unsigned size(void){return sizeof(slip_state);}
''')
    subprocess.run(['gcc','-std=c99','-O2','-Wall','-Wextra','-ffp-contract=off','-shared','-fPIC','-o',f/'l.so',f/'probe.c',f/'slip_detector.c','-lm'],check=True)
    return ctypes.CDLL(str(f/'l.so'))
def P(a,t=ctypes.c_float): return a.ctypes.data_as(ctypes.POINTER(t)) if a is not None else None
for name in ('fsr400','article','first_finger'):
    d=Design.load(name); f=Path(tempfile.mkdtemp()); lib=build(d,f); print(name,'state',lib.size())
    rng=np.random.default_rng(1); n=20000
    from scipy.signal import butter,sosfilt
    x=1.2+5e-4*rng.standard_normal(n); v=sosfilt(butter(2,[60,200],'band',fs=2000,output='sos'),rng.standard_normal(n)); v/=v.std()
    x[6000:8000]+=.01*v[6000:8000]; x[12000:12800]+=.003*v[12000:12800]; x-=.3*np.clip((np.arange(n)/2000-5)/.1,0,1)
    x[3000]=np.nan; x[9500:9600]=np.nan; x[15000]+=.5; x[16000:17500]=x[16000]
    x=x.astype('f4'); s=None
    if name=='fsr400':
        clean=np.where(np.isfinite(x),x,1.2); s=sosfilt(butter(3,67,'high',fs=2000,output='sos'),clean-clean[0])*67+1.65+5e-4*rng.standard_normal(n); s=np.clip(s,0,3.3).astype('f4'); s[18000:]=s[18000]
    st=library_settings(d); det=FastDetector(st)
    o=det.process(x.astype(float), None if s is None else s.astype(float))
    fl=np.zeros(n,np.uint8); od,fo,me,vi=(np.zeros(n,'f4') for _ in range(4))
    lib.run(P(x),P(s),n,P(fl,ctypes.c_ubyte),P(od),P(fo),P(me),P(vi))
    print(' on',o.on.mean(), np.array_equal(fl&1,o.on), 'inc',np.array_equal((fl>>1)&1,o.incipient),'rep',np.array_equal((fl>>2)&1,o.is_replaced),'out',np.array_equal((fl>>3)&1,o.is_outside))
    print(' vib',np.array_equal(vi,o.filtered_v.astype('f4')), np.flatnonzero(vi!=o.filtered_v.astype('f4'))[:5], 'mean',np.array_equal(me,o.statistic_v.astype('f4')), np.flatnonzero(me!=o.statistic_v.astype('f4'))[:5], 'floor', np.array_equal((fo*np.float32(1.85))[100:],o.threshold_v.astype('f4')[100:]), np.flatnonzero((fo*np.float32(1.85))!=o.threshold_v.astype('f4'))[:5])
