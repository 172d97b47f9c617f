"""Temporary."""
import sys, math
from dataclasses import replace
sys.path.insert(0, "/work/shared/spikes/designer")
from rsym.program.expansion import expand
from rsym.program.program import constant_value
LIB = open("/work/shared/spikes/designer/glsl.py").read().split('LIB=r"""')[1].split('"""')[0].replace("const float BIG=1e15;","const float BIG=1e15;").replace("vec2 range(","vec2 qrange(").replace("=range(","=qrange(").replace("b=range(","b=qrange(")
M={"div":"qdiv","sqrt":"qsqrt","abs":"qabs","min":"qmin","max":"qmax","sin":"qsin","cos":"qcos","exp":"qexp","log":"qlog","pow":"qpow","atan2":"qatan2"}
def model_text(form, uniforms):
    p = expand(form.builder.program({str(k): l for k, l in enumerate(form.leaves)}))
    from rsym.backends.languages import LANGUAGES
    known = uniforms.places(p); names={}; lines=[]
    lit=LANGUAGES["glsl"].literal
    O=dict(p.outputs)
    from rsym.program.program import live
    for i in live(p.nodes, list(O.values())):
        n=p.nodes[i]
        if i in known: names[i]=known[i]; continue
        if n.operation=="const": names[i]=lit(constant_value(n.data)); continue
        if n.operation=="undefined": names[i]="NAN"; continue
        if p.uniform[i]: continue
        if n.operation=="input": names[i]="XYZ"[p.coordinates.index(n.data)]; continue
        A=[names[a] for a in n.arguments]; s=[p.uniform[a] for a in n.arguments]; op=n.operation
        B=[f"qk({a})" if t else a for a,t in zip(A,s)]
        if op=="add": e=f"{B[0]}+{B[1]}"
        elif op=="neg": e=f"qneg({A[0]})"
        elif op=="mul":
            e=f"qsqr({A[0]})" if n.arguments[0]==n.arguments[1] else f"qscale({A[1]},{A[0]})" if s[0] else f"qscale({A[0]},{A[1]})" if s[1] else f"qmul({A[0]},{A[1]})"
        elif op=="select": e=f"qselect({B[0]}+qneg({B[1]}),{B[2]},{B[3]})"
        elif op=="pow" and s[1]: e=f"qpow({A[0]},{A[1]})"
        elif op=="div" and s[1]: e=f"qscale({A[0]},1./{A[1]})"
        else: e=f"{M[op]}({','.join(B)})"
        lines.append(f"vec4 v{i}={e};"); names[i]=f"v{i}"
    w=[names[O[str(k)]] for k in range(len(form.leaves))]
    for j,g in enumerate(form.gates):
        lines.append(f"vec4 m{j}=q{g.operation}({w[g.first]},{w[g.second]});"); w.append(f"m{j}")
    return LIB+"""vec4 from(vec4 v){return vec4(.5*(v.x+v.y),v.z,v.w,.5*(v.y-v.x));}
vec2 range(vec4 v){return qrange(from(v));}
vec4 model(vec4 X,vec4 Y,vec4 Z){X=from(X);Y=from(Y);Z=from(Z);\n"""+"\n".join(lines)+f"\nvec4 r=slack({w[-1]});return vec4(r.x-r.w,r.x+r.w,r.y,r.z);}}\n"
