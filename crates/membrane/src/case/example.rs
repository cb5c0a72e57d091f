//! A case file with every key.

/// A case file with every key.
pub const CASE_EXAMPLE: &str = "\
name = \"a clamped tube of rubber\"
# mesh = \"tube.msh\"             # Gmsh 2.2 or 4.1, or .vtu, beside this file: groups by name, or
[mesher]                        # a mesh of our own
kind = \"tube\"                   # also \"disc\", \"sphere\", \"square\", \"pleated\"
radius = \"10 mm\"                # tube, disc, sphere, pleated (of the fibres at the fittings)
length = \"60 mm\"                # tube, pleated
# side = \"848.53 mm\"            # square: its whole side; a quarter is meshed
# muscle = \"ppam-2-r16\"         # tube, pleated: radius, length, fibres (and the braid) of a muscle
# circumference = \"288 mm\"      # pleated: of the cloth spread out flat
# depth = \"0 mm\"                # pleated: how far the pleats stand out beyond the fibres
# fibres = 12                   # pleated
cells = [60]                    # along; a triangle mesh takes two numbers: round, and along
order = 2                       # 1 or 2
grading = 3.0                   # how much finer at the ends

# [scale]                       # for a mesh from a file
# unit = \"mm\"                   # of its coordinates
# around = 1                    # how often it stands round the z axis in the whole
# along = 1                     # and one behind the other
# length = \"60 mm\"              # between the fittings of the whole, for `contraction`

[[material]]
name = \"rubber\"
law = \"neo-hooke\"               # also \"mooney-rivlin\", \"gent\", \"hencky\", \"st-venant\", \"orthotropic\"
thickness = \"1 mm\"
shear = \"0.4 MPa\"               # neo-hooke, gent; G of orthotropic cloth
# c1 = \"0.2 MPa\"                # mooney-rivlin
# c2 = \"0.02 MPa\"
# limit = 50.0                  # gent: I1 - 3 at which the chains end
# young = \"0.5 MPa\"             # hencky, st-venant; the warp of orthotropic cloth
# weft = \"0.2 MPa\"              # orthotropic
# poisson = 0.3
wrinkles = false                # gives way to compression; the default is true for hencky, st-venant and orthotropic
# residual = 1e-6               # part of the stiffness that wrinkles leave
# bending = true                # hencky, st-venant: resists bending, D = Y h^3/12 (1 - nu^2); triangles of order 1, flat or with a pattern

[[part]]
group = \"wall\"                  # of the mesh; one group may have several parts
kind = \"sheet\"                  # revolved: \"sheet\", \"threads\"; in space: \"membrane\", \"facet\", \"cable\"
material = \"rubber\"
# fullness = 1.5                # sheet: stress-free circumference over that of the mesh
# warp = [0, 0, 1]              # membrane: direction of the material's first axis
# fibres = 40                   # threads
# angle = \"25 deg\"              # threads: to the meridian
# stiffness = \"12 kN\"           # threads, cable: EA of each; absent: without stretch
# share = 0.5                   # cable: part of it that belongs to the mesh

[[support]]                     # meshes of our own are held already where symmetry asks for it
group = \"first\"
kind = \"fitting\"                # also \"fixed\", \"plane\", \"axis\", \"slide\", \"cyclic\"
fitting = \"bottom\"              # its name
# motion = \"loaded\"             # its force is prescribed; \"placed\" (the default): its place
# normal = [0, 0, 1]            # plane: across it
# contact = true                 # plane: the cloth stops at it, because its mirror image is on the other side
# partner = \"left\"              # cyclic: the edge that it follows,
# angle = \"30 deg\"              # and the angle from there

[[support]]
group = \"last\"
kind = \"fitting\"
fitting = \"top\"

[[step]]
pressure = \"10 kPa\"             # or `volume = \"34 ml\"`, or `gas = \"isothermal\"` or \"adiabatic\" (what is in it stays)
states = 1                      # kept on the way, the last one included

[[step]]
pressure = \"30 kPa\"
places = { top = \"0 mm\" }       # of fittings, from those in the mesh; `forces = { top = \"-1 N\" }` of loaded ones
# contraction = \"10 %\"          # in place of `places`, for a muscle
states = 4
# restart = true                # begin with the mesh at rest, not with the state before

[solver]
residual = 1e-10                # of the forces at a node
iterations = 2000               # for one state
";
