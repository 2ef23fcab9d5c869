"""Time a call of pingouin takes, median in ms; our own by `cargo bench -p maveric-stats`."""
import time,statistics,numpy as np,pandas as pd,pingouin as pg,warnings
warnings.filterwarnings("ignore")
r=np.random.default_rng(1); rows=[]
for i in range(24):
    u=r.normal()
    for s in "ab":
        for t in "xy": rows.append((i,s,t,u+r.normal()))
d=pd.DataFrame(rows,columns=["id","style","traffic","y"])
def med(f,n=15):
    f(); o=[]
    for _ in range(n):
        t=time.perf_counter(); f(); o.append((time.perf_counter()-t)*1e3)
    return statistics.median(o)
print("pingouin rm_anova 24x(2x2):",med(lambda:pg.rm_anova(d,dv="y",within=["style","traffic"],subject="id")),"ms")
d["g"]=(d.id%2).astype(str); e=d[d.traffic=="x"]
print("pingouin mixed_anova 2x12 x 2:",med(lambda:pg.mixed_anova(e,dv="y",within="style",between="g",subject="id")),"ms")
print(pg.__version__)
