"""What several gear calculations share: involutes, pairs of gears, tooth roots, the load of a mesh, figures. No hooks.

Lengths are in metres or, where a name says so, in modules; angles in radians. Everything takes numbers or arrays that
broadcast, and returns the same.
"""
