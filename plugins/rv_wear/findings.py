"""Where the paper leaves something open or cannot be read literally, and what its reader must know."""

from truing import Finding

FINDINGS = [
    Finding(
        title="Tables 1, 3, 4 and 5 and all equations are lost",
        text="Only the prose of the paper and its Table 2 were at hand. The sizes of the gearing follow from the "
        "sixteen sensitivity indices: 1.56 and 1.20 need a short-width coefficient between 0.767 and 0.769, 1.06 "
        "a centre distance between 62.9 and 63.6 mm, −0.037 a product of sun radius and ratio between 1788 and "
        "1837 mm. Pin radius and disc width are those of reducers of this size. Four numbers were chosen to fit, "
        "and the rest of Table 2 then comes out; what was chosen is marked as calibrated above.",
    ),
    Finding(
        title="One wear is printed, and four unknowns make it",
        text="Disc width, pressure viscosity, roughness and the share of the worse disc are lost, and the wear of "
        "3.127 µm fixes one of them. Taken was the roughness, 0.694 µm. The wear coefficient goes with the power "
        "−7.4 of the pressure viscosity: 2.1e-8 instead of 2.2e-8 1/Pa gives 3.84 µm. Before this is used for "
        "another reducer, one wear must be measured. The constants of the regression are quoted from literature "
        "that cites it.",
    ),
    Finding(
        title="Zones of a micrometre at six standard deviations",
        text="Mean 0.7 arcmin and reliability 88.7 % after 6000 h need a standard deviation of 0.041 arcmin. With six "
        "of them in a zone, pins are made and set to about one micrometre, which is tighter than usual practice. "
        "Either the distributions of the paper are narrower than a sixth of its zones, or the errors of the ten "
        "or so loaded pins average out, which narrows factors 7, 8 and 10 by the root of their number. The zones "
        "here are one split of many that give the same mean and standard deviation.",
    ),
    Finding(
        title="A reliability of 100 % is no number that can be met",
        text="The paper asks for 100 % and says that the backlash then stays below its limit with every size at its "
        "worst. Read literally, all zones at their ends at once, this needs an equidistant modification of about "
        "−0.038 mm and 3.4 µm of wear, far from the printed 3.207 µm. In the paper's counting it means that none "
        "of the machines drawn fails; here it is read as 0.999.",
    ),
    Finding(
        title="The cost functions are read as powers",
        text="Their equations are lost and only coefficients are printed. As powers of the width in millimetres they "
        "give 1403 yuan for the zones here (the paper: 1402). Read as plain exponentials they give 93 yuan, and "
        "91 in the form a1 exp(-a2 E) + E / (a3 E + a4) + a5; neither would fall by the printed 8 % when a zone "
        "of a micrometre is doubled. The input cost_form chooses.",
    ),
    Finding(
        title="The wear coefficient: at every point, or once",
        text="The paper does not say whether the coefficient is evaluated with the force of every contact or once at "
        "the pitch point. At every point is the default. Once makes the wear nearly proportional to time (2.18 "
        "instead of 2.39 µm after 4000 h) and needs about twice the roughness for the same 3.127 µm. The input "
        "wear_coefficient chooses.",
    ),
    Finding(
        title="The lower bound of the equidistant modification",
        text="The paper prints −0.053 to 0.011 mm and not the conditions. No interference gives 0.0111 mm. At the "
        "other end, clearances of at most twice the radial one give −0.0538 mm; at most the approach under load "
        "gives −0.0388 mm with the disc width of 20 mm.",
    ),
    Finding(
        title="Reliability between 3000 and 5000 h",
        text="The paper says that the reliability begins to fall after 4000 h. Here it is 99.99 % after 3000 h, 99.7 "
        "% after 4000 h and 97.3 % after 5000 h; no number is printed for these times.",
    ),
    Finding(
        title="The deepest wear is not the play that is felt",
        text="The paper adds the deepest wear of the flank to the backlash as if the whole disc had been ground "
        "thinner. The play ends where the first pin touches: without load 0.3 to 0.5 µm of the 3.1 µm are felt, "
        "under load more. The paper's way is the cautious one and the default; the input lost_motion_share "
        "changes it.",
    ),
    Finding(
        title="Factor 14 and the sign of factor 11",
        text="The formula of the eccentricity error stands in a footnote that is lost; the contact normal at the "
        "longest arm stands across the crank, so to first order the error does nothing, and the printed 0.00016 "
        "was taken. The cumulative pitch error narrows the backlash as printed; its zone is symmetric, so no "
        "result depends on it.",
    ),
]
