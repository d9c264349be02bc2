"""Where the paper cannot be right, and what its reader must know."""

from truing import Finding

FINDINGS = [
    Finding(
        title="Misprint: the ground pivot angle",
        text="The paper prints alpha_21 = 0.117 rad (and 3.023 rad on side 2, which is the same number). With it "
        "nothing else in the paper comes out: the salience sum is 0.797 instead of 0.877, the order of adjustment "
        "is another, and the slider would be lowest twice per turn. With 0.367 rad every coefficient of Table 4 "
        "agrees within 0.05 % and both salience sums within 0.12 %. Likely causes: a lost pi (0.117 pi = 0.3676), "
        "or a design point M = (1.300, 0.500) m, whose distance 1.3928 m is the printed 1.393 m. The value was "
        "chosen to fit: one number against a table of them. Therefore ground_pivot_angle defaults to 0.367 rad.",
    ),
    Finding(
        title="Misprint: the unit of the tilt limit",
        text="The limit is printed as 0.0013 rad. The tilt scatters with a standard deviation of 16 µrad, so 0.0013 "
        "rad is 82 of them and the reliability would be 1 without any tightening. In degrees the limit is 23 µrad "
        "and the printed reliabilities follow: 0.849 and 0.9965 with 0.0013 degree, 0.856 and 0.997 with 0.001324 "
        "degree, which rounds to the same print (the paper: 0.857 and 0.9973).",
    ),
    Finding(
        title="The printed reliabilities leave out the errors across the radius",
        text="Table 3 tolerates every joint along y and along z. The printed pair of position reliabilities fixes the "
        "variance that tightening links cannot change: 41 µm². The errors along the radius give that (with ±0.05 "
        "mm at the crank pivots; Table 3 says ±0.1 mm). The errors across it alone would add 263 µm². A "
        "sensitivity in m/rad used beside one in mm/mm would lose a factor of a million in just these terms; that "
        "is an inference, the paper does not say so.",
    ),
    Finding(
        title="With all its installation errors the press does not reach its goals",
        text="In the reading 'complete', with every tolerance of Table 3 and the limit 0.0013 degree, the "
        "reliabilities are 0.492 and 0.776 at the start. After twelve adjustments every link is at IT5 and they "
        "are 0.669 and 0.928: the goals 0.88 and 0.95 cannot be reached by tightening links. The money belongs "
        "into the joints on slider and frame.",
    ),
    Finding(
        title="Misprint: the crank pivot in the lists of key errors",
        text="Both lists name the points H and M but write delta alpha_11(12), the angle of the crank pivot. It must "
        "read delta alpha_21(22), the angle of the ground joint M: with the crank pivot the sum for the position "
        "would be 0.72 instead of the printed 0.8766.",
    ),
    Finding(
        title="Sign of the slider joint's height in Eqs. (5) and (6)",
        text="The paper adds l delta beta_2 to the height of the joint. A joint that sits too low on the slider raises "
        "the slider, so the face height takes -l delta beta_21 on side 1 and +l delta beta_22 on side 2 (polar "
        "angles). No variance can tell the difference, a diagnosis can.",
    ),
    Finding(
        title="Salience depends on units",
        text="The salience adds metres per metre to metres per radian. In degrees every angle would drop to a sixtieth "
        "and the ranking would turn over. It is shown to repeat the paper; to decide anything, use the share of "
        "the variance.",
    ),
]
