"""Where the paper leaves something open or cannot be read literally, and what its reader must know."""

from truing import Finding

FINDINGS = [
    Finding(
        title="The table and all figures of results are lost",
        text="Of the paper the text, its equations and the inputs of the example were at hand, but neither the table "
        "of groups nor the flow chart nor the figures with stresses. Face width, profile shifts, material, "
        "quality and the number of planets are printed nowhere; usual ones were taken, and every stress here is "
        "ours alone. What the formulas are worth is shown by examples of others, in the comparison above.",
    ),
    Finding(
        title="The numbering of the groups cannot be recovered",
        text="The paper names groups up to number 22 and rates number 5. Its tolerance and how far it tried pins stood "
        "in the flow chart. Forty pins and a tolerance of 0.01 is the simplest reading that has at least 22 "
        "groups: it has 25. A tolerance of 0.04 gives 102, even pins from 30 to 60 give 422, from 20 to 80 give "
        "687, and one pin circle instead of all that the torque permits leaves 5. Group 5 here, 23/63, need not "
        "be the paper's.",
    ),
    Finding(
        title="The paper calls nine groups better and gives no rule",
        text="It names 3, 7, 10, 12, 13, 15, 20, 21 and 22, for accuracy of transmission and distribution of load. "
        "Read here: hunting teeth (no common factor of sun and planet, so that every tooth meets every other and no "
        "error is repeated), and planets that mesh in phase (their number divides the teeth of the sun, so that they "
        "carry alike at any moment). Of the 25 groups 15 have hunting teeth and 4 both, with two planets: 4, 8, 15 "
        "and 21. Since the numbering is lost this is no comparison. Both together need planets of several kinds: "
        "planets that are all alike want the sum of the teeth divided by their number.",
    ),
    Finding(
        title="The cube root wants newton millimetres",
        text="The radius of the pin circle is 0.85 to 1.3 times the cube root of the output torque. That is "
        "millimetres for a torque in N mm, as the printed 9 550 000 says; with N m it would be ten times too "
        "small. The 1078 N m of the catalogue give 87 to 133 mm, the size of such reducers.",
    ),
    Finding(
        title="An even number of pins is no condition of one tooth difference",
        text="The paper calls it that. The one tooth by which pins exceed the teeth of a disc is already in equation "
        "1. The number of pins is even so that two equal discs, half a turn of the crank apart, fit one ring of "
        "pins.",
    ),
    Finding(
        title="At least 17 teeth is a rule without profile shift",
        text="With shift a sun may have fewer teeth and not be undercut. The catalogue of the maker proves it: its "
        "five ratios 81, 111, 127.7, 161 and 175.2 come out with 40 pins and sun and planet of 75 teeth together, "
        "25/50, 20/55, 18/57, 15/60 and 14/61, all at 46.875 mm. The input fewest_sun_teeth opens the search to "
        "them.",
    ),
    Finding(
        title="The torque of the search is not the torque of the gears",
        text="Equation 5 multiplies input power by the efficiency and divides by the speed of the output: the torque "
        "at the output, which sizes the pin circle. Sun and planet carry the torque of the input, 1/(i eta) of "
        "it, 12.96 instead of 1285.8 N m.",
    ),
    Finding(
        title="Efficiency 0.894 or 0.749",
        text="Equations 6 to 8 give 0.894 from input to output, 1285.8 N m at 15 turns per minute. For the same power "
        "and speed the catalogue rates the reducer with 1078 N m, 0.749. The equations have the losses of meshes "
        "and bearings under load, but none that are there without load: seals, grease, and friction of pins.",
    ),
    Finding(
        title="Equations 2, 5 and 8 are read, not copied",
        text="In the copy at hand equation 2 has no bars of an absolute value, equation 5 no fraction bar and equation "
        "8 no brackets. Equation 8 is read as the ratio of a lossy train over that of one without losses, so that "
        "it is 1 where both mesh efficiencies are.",
    ),
    Finding(
        title="Contact stress at the pitch point only",
        text="The paper leaves out Z_B and Z_D of ISO 6336-2, which carry the stress from the pitch point to the inner "
        "point of single contact. For a sun of 20 teeth that is 7.5 % more; with it 0.6 % of the permissible "
        "stress is left, without it 7.5 %. They are applied here; single_contact = false leaves them out.",
    ),
    Finding(
        title="Small gears get a large face load factor",
        text="By method C the factor is 1.54 for the example although the flanks are crowned: under 54 N/mm the "
        "deviations of grade 6 are more than the deflection. For crowned suns that align themselves 1.1 to 1.3 is "
        "usual; stated_face_factor = 1.2 takes 8 % off the contact stress. Measure it, or state where it is from.",
    ),
    Finding(
        title="Two conventions of root stress",
        text="The paper, as older standards, loads the tooth at its tip and takes part of it off again by a contact "
        "ratio factor. Method B of ISO 6336-3 loads it at the outer point of single contact. The factors look "
        "alike and differ: for the sun 2.80 and 1.55 by one, 1.55 and 1.83 by the other. Both stand on the sheet; "
        "the first is checked, as in the paper.",
    ),
    Finding(
        title="Robots reverse, and the paper does not say so",
        text="A planet of this stage meshes with the sun alone, so its teeth are not bent to both sides in each turn. "
        "A robot that goes to and fro bends them to both sides all the same; ISO 6336-3 then takes about 0.7 of "
        "the endurance limit for bending. State bending_limit_sun and bending_limit_planet accordingly.",
    ),
    Finding(
        title="The first group of the list is the one that is built",
        text="Of the 25 groups the smallest, 20/55/40, has the centre distance of the maker's catalogue and the ratio "
        "111. The paper prefers larger ones by accuracy and sharing of load. Larger groups carry more: contact "
        "stress falls from 1087 to 709 MPa from the first to the last, and the centre distance grows by 80 %.",
    ),
]
