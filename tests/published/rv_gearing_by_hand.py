"""One gear pair rated step by step as the standards are written: plain floats, N, mm, um, MPa, 1/min and degrees.

ISO 21771 for the geometry, ISO 1328-1:1995 for the deviations, ISO 6336-1 to -3:2006 (method B, face load method C) for
the factors, GB/T 3480-1997 for the load at the tip. Nothing of the calculation under test is used.
"""

from math import acos, atan, cos, degrees, hypot, pi, radians, sin, sqrt, tan
from typing import Any

Case = dict[str, Any]
WEIGHTS = {"none": (1, 1), "crowned": (1, 0.5), "helix_corrected": (0.1, 1), "crowned_and_corrected": (0.1, 0.5),
           "end_relief": (0.7, 0.7)}  # fmt: skip


def inv(angle: float) -> float:
    return tan(angle) - angle


def angle_with(value: float) -> float:
    """The angle with this involute, by halving an interval."""
    low, high = 0.0, pi / 2 - 1e-9
    for _ in range(200):
        middle = (low + high) / 2
        low, high = (middle, high) if inv(middle) < value else (low, middle)
    return low


def geometry(c: Case) -> Case:
    """Sizes of both gears and of the mesh at the centre distance without backlash, moved apart by ``apart`` (mm)."""
    m, beta, alpha, z, x = c["m"], radians(c["beta"]), radians(c["alpha"]), c["z"], c["x"]
    alpha_t = atan(tan(alpha) / cos(beta))
    d = [m * each / cos(beta) for each in z]
    db = [each * cos(alpha_t) for each in d]
    da = [each + 2 * m * (c["ha"] + shift) for each, shift in zip(d, x, strict=True)]
    df = [each - 2 * m * (c["hf"] - shift) for each, shift in zip(d, x, strict=True)]
    tight = angle_with(inv(alpha_t) + 2 * tan(alpha) * (x[0] + x[1]) / (z[0] + z[1]))
    a = (d[0] + d[1]) / 2 * cos(alpha_t) / cos(tight) + c["apart"]
    alpha_wt = acos((db[0] + db[1]) / 2 / a)
    p_bt = pi * m * cos(alpha_t) / cos(beta)
    path = [sqrt((outer / 2) ** 2 - (inner / 2) ** 2) for outer, inner in zip(da, db, strict=True)]
    eps_a = (path[0] + path[1] - a * sin(alpha_wt)) / p_bt
    eps_b = c["b"] * sin(beta) / (pi * m)
    beta_b = atan(tan(beta) * cos(alpha_t))
    backlash = (db[0] + db[1]) * (inv(alpha_wt) - inv(tight)) * cos(beta_b) if c["apart"] > 0 else 0.0
    return {
        "d": d, "db": db, "da": da, "df": df, "a": a, "alpha_t": alpha_t, "alpha_wt": alpha_wt, "p_bt": p_bt,
        "eps_a": eps_a, "eps_b": eps_b, "eps_g": eps_a + eps_b, "beta_b": beta_b, "u": z[1] / z[0],
        "zn": [each / (cos(beta_b) ** 2 * cos(beta)) for each in z], "backlash": backlash,
    }  # fmt: skip


def stiffness(c: Case, g: Case, w: float) -> tuple[float, float]:
    """c' and c_gamma_alpha, N/(mm um)."""
    zn, x = g["zn"], c["x"]
    q = 0.04723 + 0.15551 / zn[0] + 0.25791 / zn[1] - 0.00635 * x[0] - 0.11654 * x[0] / zn[0]
    q += -0.00193 * x[1] - 0.24188 * x[1] / zn[1] + 0.00529 * x[0] ** 2 + 0.00182 * x[1] ** 2
    rack = (1 + 0.5 * (1.2 - c["hf"])) * (1 - 0.02 * (20 - c["alpha"]))
    modulus = 2 * c["E"][0] * c["E"][1] / (c["E"][0] + c["E"][1]) / 206000
    single = 0.8 * rack * cos(radians(c["beta"])) / q * modulus
    if w < 100:
        single *= (w / 100) ** 0.25
    return single, single * (0.75 * g["eps_a"] + 0.25)


def deviations(c: Case, d: float) -> tuple[float, float, float]:
    """f_pt, f_falpha, f_Hbeta, um."""
    grade = sqrt(2) ** (c["Q"] - 5)
    return (
        (0.3 * (c["m"] + 0.4 * sqrt(d)) + 4) * grade,
        (2.5 * sqrt(c["m"]) + 0.17 * sqrt(d) + 0.5) * grade,
        (0.07 * sqrt(d) + 0.45 * sqrt(c["b"]) + 3) * grade,
    )


def run_in(c: Case, deviation: float, v: float, *, face: bool) -> float:
    """y_alpha (or y_f) and y_beta, um: the mean of both gears."""
    total = 0.0
    for limit in c["sH"]:
        if c["material"] == "through_hardened":
            worth = (320 if face else 160) / limit * deviation
            bound = (25600 if face else 12800) / limit
            if v > 5:
                worth = min(worth, bound)
            if v > 10:
                worth = min(worth, bound / 2)
        else:
            worth = min(0.15 * deviation, 6) if face else min(0.075 * deviation, 3)
        total += worth
    return total / 2


def dynamic(c: Case, g: Case, w: float, stiff: tuple[float, float], left: tuple[float, float]) -> Case:
    """N, N_S and K_V."""
    rho = c["rho"] * 1e-9  # kg/mm3
    mean = [(g["da"][i] + g["df"][i]) / 2 for i in (0, 1)]
    inertia = [pi / 32 * rho * (1 - c["q"][i] ** 4) * mean[i] ** 4 for i in (0, 1)]
    star = [inertia[i] / (g["db"][i] / 2) ** 2 for i in (0, 1)]
    m_red = star[0] * star[1] / (star[0] + c["np"] * star[1])
    n_e = 30000 / (pi * c["z"][0]) * sqrt(stiff[1] / m_red)
    n = c["n_rel"] / n_e
    n_s = 0.85 if w >= 100 else 0.5 + 0.35 * sqrt(w / 100)
    e = g["eps_g"]
    if e <= 2:
        cv = [0.32, 0.34, 0.23, 0.90, 0.47, 0.47]
    else:
        cv = [0.32, 0.57 / (e - 0.3), 0.096 / (e - 1.56), (0.57 - 0.05 * e) / (e - 1.44), 0.47, 0.12 / (e - 1.74)]
    cv7 = 0.75 if e <= 1.5 else 0.125 * sin(pi * (e - 2)) + 0.875 if e <= 2.5 else 1.0
    bp, bf = stiff[0] * left[0] / w, stiff[0] * left[1] / w
    bk = 1.0 if c["Q"] >= 6 else abs(1 - stiff[0] * c["Ca"] / w)
    main = 1 + cv[0] * bp + cv[1] * bf + cv[3] * bk
    above = cv[4] * bp + cv[5] * bf + cv7
    if n <= n_s:
        kv = 1 + n * (cv[0] * bp + cv[1] * bf + cv[2] * bk)
    elif n <= 1.15:
        kv = main
    elif n < 1.5:
        kv = above + (main - above) / 0.35 * (1.5 - n)
    else:
        kv = above
    return {"resonance_ratio": n, "resonance_limit": n_s, "resonance_speed": n_e, "reduced_mass": m_red, "K_V": kv}


def face(c: Case, g: Case, fm: float, v: float, c_gb: float) -> tuple[float, float]:
    """K_Hbeta and K_Fbeta for a mean line load F_m/b."""
    slopes = [deviations(c, d)[2] for d in g["d"]]
    b1, b2 = WEIGHTS[c["form"]]
    f_sh = fm * 0.023 * (c["b"] / g["d"][0]) ** 2
    f_x = max(1.33 * b1 * f_sh + b2 * hypot(*slopes), 0.005 * fm, 0.5 * max(slopes))
    f_y = f_x - run_in(c, f_x, v, face=True)
    r = f_y * c_gb / (2 * fm)
    k_h = 1 + r if r <= 1 else 2 * sqrt(r)
    h_b = min(c["m"] * (c["ha"] + c["hf"]) / c["b"], 1 / 3)
    return k_h, k_h ** (1 / (1 + h_b + h_b**2))


def transverse(g: Case, x: float, z_eps: float) -> tuple[float, float]:
    """K_Halpha and K_Falpha; ``x`` is c_gamma (f_pb - y_alpha) / (F_tH/b)."""
    e = g["eps_g"]
    k = e / 2 * (0.9 + 0.4 * x) if e <= 2 else 0.9 + 0.4 * sqrt(2 * (e - 1) / e) * x
    return max(1, min(k, e / (g["eps_a"] * z_eps**2))), max(1, min(k, e / (0.25 * g["eps_a"] + 0.75)))


def root(c: Case, g: Case, i: int, *, tip: bool) -> tuple[float, float, float]:
    """Form factor, stress correction and q_s with the load at the tip or at the outer point of single contact."""
    m, alpha, zn, x = c["m"], radians(c["alpha"]), g["zn"][i], c["x"][i]
    rho, hf = c["rho_f"] * m, c["hf"] * m
    big_e = pi / 4 * m - hf * tan(alpha) - (1 - sin(alpha)) * rho / cos(alpha)
    big_g = rho / m - hf / m + x
    big_h = 2 / zn * (pi / 2 - big_e / m) - pi / 3
    theta = pi / 6
    for _ in range(300):
        theta = 2 * big_g / zn * tan(theta) - big_h
    chord = zn * sin(pi / 3 - theta) + sqrt(3) * (big_g / cos(theta) - rho / m)
    fillet = rho / m + 2 * big_g**2 / (cos(theta) * (zn * cos(theta) ** 2 - 2 * big_g))
    eps_an = g["eps_a"] / cos(g["beta_b"]) ** 2
    dn = m * zn
    dbn, dan = dn * cos(alpha), dn + g["da"][i] - g["d"][i]
    reach = sqrt((dan / 2) ** 2 - (dbn / 2) ** 2) - (0 if tip else pi * m * cos(alpha) * (eps_an - 1))
    den = 2 * sqrt(reach**2 + (dbn / 2) ** 2)
    alpha_e = acos(dbn / den)
    gamma = (0.5 * pi + 2 * tan(alpha) * x) / zn + inv(alpha) - inv(alpha_e)
    angle = alpha_e - gamma
    arm = 0.5 * (
        (cos(gamma) - sin(gamma) * tan(angle)) * den / m - zn * cos(pi / 3 - theta) - (big_g / cos(theta) - rho / m)
    )
    form = 6 * arm * cos(angle) / (chord**2 * cos(alpha))
    q_s, slender = chord / (2 * fillet), chord / arm
    return form, (1.2 + 0.13 * slender) * q_s ** (1 / (1.21 + 2.3 / slender)), q_s


def life(c: Case, n: float) -> tuple[float, float]:
    """Z_NT and Y_NT."""
    nitrided, hardened = c["material"] == "nitrided", c["material"] == "case_hardened"
    most, knee, slope, tail = (1.3, 2e6, 0.0876, 0.0191) if nitrided else (1.6, 5e7, 0.0756, 0.0306)
    z = min(most, (knee / n) ** slope) if n <= knee else max(0.85, (knee / n) ** tail)
    most, slope = (1.6, 0.0587) if nitrided else (2.5, 0.115) if hardened else (2.5, 0.16)
    y = min(most, (3e6 / n) ** slope) if n <= 3e6 else max(0.85, (3e6 / n) ** 0.02)
    return z, y


def root_strength(c: Case, i: int, q_s: float) -> tuple[float, float, float]:
    """Y_deltarelT, Y_RrelT and Y_X."""
    slip = {"case_hardened": 0.003, "nitrided": 0.1005, "through_hardened": 0.0064}[c["material"]]
    delta = (1 + sqrt(0.2 * slip * (1 + 2 * q_s))) / (1 + sqrt(1.2 * slip))
    rz, m = c["RzF"][i], c["m"]
    if c["material"] == "nitrided":
        rough = 1.025 if rz < 1 else 4.299 - 3.259 * (rz + 1) ** 0.0058
    else:
        rough = 1.12 if rz < 1 else 1.674 - 0.529 * (rz + 1) ** 0.1
    if c["material"] == "through_hardened":
        size = 1.0 if m <= 5 else 1.03 - 0.006 * m if m < 30 else 0.85
    else:
        size = 1.0 if m <= 5 else 1.05 - 0.01 * m if m < 25 else 0.8
    return delta, rough, size


def contact(c: Case, g: Case, v: float, z_eps: float) -> Case:
    """Z_H, Z_E, Z_beta, Z_B, Z_D, Z_L, Z_V, Z_R."""
    wt, z, eps_a, eps_b = g["alpha_wt"], c["z"], g["eps_a"], g["eps_b"]
    bodies = sum((1 - nu**2) / modulus for nu, modulus in zip(c["nu"], c["E"], strict=True))
    roll = [sqrt((g["da"][i] / g["db"][i]) ** 2 - 1) for i in (0, 1)]
    singles = []
    for i, j in ((0, 1), (1, 0)):
        raised = tan(wt) / sqrt((roll[i] - 2 * pi / z[i]) * (roll[j] - (eps_a - 1) * 2 * pi / z[j]))
        if eps_b >= 1:
            singles.append(1.0)
        else:
            singles.append(max(1.0, raised - eps_b * (raised - 1)))
    limit = min(c["sH"])
    c_l = 0.83 if limit < 850 else 0.91 if limit > 1200 else limit / 4375 + 0.6357
    c_r = 0.15 if limit < 850 else 0.08 if limit > 1200 else 0.32 - 0.0002 * limit
    rho = [0.5 * db * tan(wt) for db in g["db"]]
    rz10 = (c["Rz"][0] + c["Rz"][1]) / 2 * (10 * (rho[0] + rho[1]) / (rho[0] * rho[1])) ** (1 / 3)
    return {
        "Z_H": sqrt(2 * cos(g["beta_b"]) * cos(wt) / (cos(g["alpha_t"]) ** 2 * sin(wt))),
        "Z_E": sqrt(1 / (pi * bodies)),
        "Z_eps": z_eps,
        "Z_beta": 1 / sqrt(cos(radians(c["beta"]))),
        "Z_B": singles[0],
        "Z_D": singles[1],
        "Z_L": c_l + 4 * (1 - c_l) / (1.2 + 134 / c["nu40"]) ** 2,
        "Z_V": c_l + 0.02 + 2 * (1 - c_l - 0.02) / sqrt(0.8 + 32 / v),
        "Z_R": (3 / rz10) ** c_r,
    }


def rate(c: Case) -> Case:
    """Everything that is compared, by the names of the results, in the units of the standards."""
    g = geometry(c)
    v = pi * g["d"][0] * c["n_rel"] / 60000
    force = 2000 * c["T1"] / (c["np"] * g["d"][0])
    w = force * c["KA"] / c["b"]
    stiff = stiffness(c, g, w)
    made = [deviations(c, d) for d in g["d"]]
    f_pb, f_fa = max(made[0][0], made[1][0]) * cos(g["alpha_t"]), max(made[0][1], made[1][1])
    left = f_pb - run_in(c, f_pb, v, face=False), f_fa - run_in(c, f_fa, v, face=False)
    k = dynamic(c, g, w, stiff, left)
    fm = w * k["K_V"] * c["KHp"]
    k_hb, k_fb = face(c, g, fm, v, 0.85 * stiff[1])
    eps_a, eps_b = g["eps_a"], g["eps_b"]
    z_eps = sqrt((4 - eps_a) / 3 * (1 - eps_b) + eps_b / eps_a) if eps_b < 1 else sqrt(1 / eps_a)
    k_ha, k_fa = transverse(g, stiff[1] * left[0] / (fm * k_hb), z_eps)
    z = contact(c, g, v, z_eps)
    sigma_h0 = z["Z_H"] * z["Z_E"] * z_eps * z["Z_beta"] * sqrt(force / (g["d"][0] * c["b"]) * (g["u"] + 1) / g["u"])
    k_h = c["KA"] * k["K_V"] * k_hb * k_ha * c["KHp"]
    k_f = c["KA"] * k["K_V"] * k_fb * k_fa * (1 + 1.5 * (c["KHp"] - 1))
    eps_an = eps_a / cos(g["beta_b"]) ** 2
    y_beta = 1 - min(eps_b, 1) * min(c["beta"], 30) / 120
    deep = 1.0 if eps_an <= 2.05 or c["Q"] > 4 else 2.366 - 0.666 * eps_an if eps_an <= 2.5 else 0.7
    found: Case = {
        "centre_distance": g["a"], "working_angle": degrees(g["alpha_wt"]), "contact_ratio": eps_a,
        "overlap_ratio": eps_b, "backlash": 1000 * g["backlash"], "tangential_force": force,
        "pitch_line_velocity": v, "line_load": w,
        "tooth_stiffness": stiff[0], "mesh_stiffness": stiff[1], "pitch_left": left[0], "profile_left": left[1],
        "resonance_ratio": k["resonance_ratio"], "resonance_limit": k["resonance_limit"], "dynamic_factor": k["K_V"],
        "resonance_speed": k["resonance_speed"], "reduced_mass": k["reduced_mass"], "face_factor": k_hb,
        "face_factor_bending": k_fb, "transverse_factor": k_ha, "transverse_factor_bending": k_fa,
        "zone_factor": z["Z_H"], "elasticity_factor": z["Z_E"], "contact_ratio_factor": z_eps,
        "helix_factor": z["Z_beta"], "single_contact_factor_sun": z["Z_B"], "single_contact_factor_planet": z["Z_D"],
        "lubricant_factor": z["Z_L"], "velocity_factor": z["Z_V"], "roughness_factor": z["Z_R"],
        "nominal_contact_stress": sigma_h0,
    }  # fmt: skip
    turns = 60 * c["n_rel"] * c["Lh"]
    for i, name in ((0, "sun"), (1, "planet")):
        y_fa, y_sa, q_s = root(c, g, i, tip=True)
        y_f, y_s, _ = root(c, g, i, tip=False)
        z_nt, y_nt = life(c, turns * c["np"] if i == 0 else turns / g["u"])
        delta, rough, size = root_strength(c, i, q_s)
        spread = force / (c["b"] * c["m"]) * y_beta * k_f
        may_h = c["sH"][i] * z_nt * z["Z_L"] * z["Z_V"] * z["Z_R"]
        may_f = c["sF"][i] * 2 * y_nt * delta * rough * size
        of_gear = {
            "form_factor": y_fa, "stress_correction": y_sa, "form_factor_outer": y_f, "stress_correction_outer": y_s,
            "contact_life_factor": z_nt, "bending_life_factor": y_nt, "notch_sensitivity": delta, "root_surface": rough,
            "bending_size": size, "root_stress": spread * y_fa * y_sa * (0.25 + 0.75 / eps_an),
            "root_stress_outer": spread * y_f * y_s * deep,
            "contact_stress": z["Z_B" if i == 0 else "Z_D"] * sigma_h0 * sqrt(k_h),
            "permitted_contact_stress": may_h / c["SH"], "permitted_root_stress": may_f / c["SF"],
        }  # fmt: skip
        of_gear["contact_safety"] = may_h / of_gear["contact_stress"]
        of_gear["root_safety"] = may_f / of_gear["root_stress"]
        of_gear["root_safety_outer"] = may_f / of_gear["root_stress_outer"]
        found |= {f"{key}_{name}": value for key, value in of_gear.items()}
    return found
