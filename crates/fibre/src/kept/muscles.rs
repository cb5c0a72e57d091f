//! Very different muscles, some at the borders of what is solved.

/// Names with keys of muscle files.
pub(super) const MUSCLES: [(&str, &str); 30] = [
    ("pleated", "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\n"),
    (
        "pleated elastic",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\nfibre = { stiffness = \"6 kN\" }\n",
    ),
    (
        "pleated slender",
        "kind = \"pleated\"\nlength = \"300 mm\"\nradius = \"12 mm\"\nfibres = 24\nfibre = { stiffness = \"25 kN\" }\n",
    ),
    (
        "pleated smooth",
        "kind = \"pleated\"\nlength = \"60 mm\"\nradius = \"25 mm\"\nfibres = \"continuous\"\n",
    ),
    (
        "cylinder",
        "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\n",
    ),
    (
        "cylinder rubber",
        "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"cylinder\"\nwall = \"2 mm\"\n\
         fibres = 60\nfibre = { stiffness = \"9 kN\" }\neffects = { bladder-elasticity = { c10 = \"0.25 MPa\", c01 = \"0.02 MPa\" } }\n",
    ),
    (
        "braid",
        "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\n",
    ),
    (
        "braid short",
        "kind = \"braided\"\nlength = \"60 mm\"\nradius = \"12 mm\"\nbraid_angle = \"28 deg\"\nends = \"clamped\"\n",
    ),
    (
        "braid narrow ends",
        "kind = \"braided\"\nlength = \"120 mm\"\nradius = \"12 mm\"\nbraid_angle = \"24 deg\"\nends = \"clamped\"\neffects = { end-radius = { radius = \"7 mm\" } }\n",
    ),
    (
        "braid wide ends",
        "kind = \"braided\"\nlength = \"150 mm\"\nradius = \"10 mm\"\nbraid_angle = \"24 deg\"\nends = \"clamped\"\neffects = { end-radius = { radius = \"12 mm\" } }\n",
    ),
    (
        "braid rubber",
        "kind = \"braided\"\nlength = \"200 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\nwall = \"2 mm\"\n\
         effects = { bladder-elasticity = { c10 = \"0.3 MPa\" } }\n",
    ),
    (
        "braid stiff rubber",
        "kind = \"braided\"\nlength = \"90 mm\"\nradius = \"9 mm\"\nbraid_angle = \"30 deg\"\nends = \"clamped\"\nwall = \"2.5 mm\"\n\
         effects = { bladder-elasticity = { c10 = \"0.9 MPa\", c01 = \"0.1 MPa\" } }\n",
    ),
    (
        "braid elastic",
        "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\nfibres = 60\n\
         fibre = { stiffness = \"9 kN\" }\n",
    ),
    (
        "braid elastic rubber",
        "kind = \"braided\"\nlength = \"140 mm\"\nradius = \"10 mm\"\nbraid_angle = \"27 deg\"\nends = \"clamped\"\nwall = \"1.5 mm\"\n\
         fibres = 60\nfibre = { stiffness = \"9 kN\" }\neffects = { bladder-elasticity = { c10 = \"0.3 MPa\" } }\n",
    ),
    (
        "braid gas inside",
        "kind = \"braided\"\nlength = \"250 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\nwall = \"2 mm\"\n\
         effects = { wall-thickness = { thickness = \"1 mm\" }, bladder-elasticity = { c10 = \"0.2 MPa\" } }\n",
    ),
    (
        "pleated pleats",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\nfibre = { stiffness = \"12.5 kN\" }\n\
         effects = { pleat-depth = { depth = \"2 mm\" } }\n",
    ),
    (
        "pleated cloth",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\nfibre = { stiffness = \"12.5 kN\" }\n\
         effects = { limited-unfolding = { hoop_stiffness = \"81 kN/m\", unfolded_radius = \"28 mm\" } }\n",
    ),
    (
        "pleated lobes",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 12\neffects = { lobes = { circumference = \"330 mm\" } }\n",
    ),
    (
        "pleated narrow lobes",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 12\neffects = { lobes = { circumference = \"112 mm\" } }\n",
    ),
    (
        "pleated deep lobes",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 12\n\
         effects = { lobes = { circumference = \"125 mm\" }, pleat-depth = { depth = \"2 mm\" } }\n",
    ),
    (
        "pleated lobes in cloth",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 12\n\
         effects = { lobes = { circumference = \"330 mm\" }, limited-unfolding = { hoop_stiffness = \"81 kN/m\", unfolded_radius = \"28 mm\" } }\n",
    ),
    (
        "pleated twist",
        "kind = \"pleated\"\nlength = \"110 mm\"\nradius = \"16 mm\"\nfibres = 40\neffects = { fibre-misalignment = { angle = \"4 deg\" } }\n",
    ),
    (
        "long braid of elastic fibres",
        "kind = \"braided\"\nlength = \"539 mm\"\nradius = \"5.66 mm\"\nbraid_angle = \"24.3 deg\"\nends = \"clamped\"\nfibres = 60\n\
         fibre = { stiffness = \"50.8 kN\" }\n",
    ),
    (
        "braid with a waist",
        "kind = \"braided\"\nlength = \"665 mm\"\nradius = \"25 mm\"\nbraid_angle = \"37.6 deg\"\nends = \"clamped\"\n\
         effects = { end-radius = { radius = \"8.1 mm\" } }\n",
    ),
    (
        "braid in cloth",
        "kind = \"braided\"\nlength = \"300 mm\"\nradius = \"7.7 mm\"\nbraid_angle = \"47.8 deg\"\nends = \"clamped\"\n\
         effects = { limited-unfolding = { hoop_stiffness = \"8.7 kN/m\", unfolded_radius = \"7.73 mm\" } }\n",
    ),
    (
        "braid with gas far inside",
        "kind = \"braided\"\nlength = \"487 mm\"\nradius = \"12.4 mm\"\nbraid_angle = \"10.1 deg\"\nends = \"clamped\"\n\
         effects = { wall-thickness = { thickness = \"3.54 mm\" } }\n",
    ),
    (
        "braid of hard rubber",
        "kind = \"braided\"\nlength = \"54 mm\"\nradius = \"19 mm\"\nbraid_angle = \"20 deg\"\nends = \"clamped\"\nwall = \"1.6 mm\"\n\
         effects = { end-radius = { radius = \"9 mm\" }, bladder-elasticity = { c10 = \"20 MPa\" } }\n",
    ),
    (
        "pleated soft lobes",
        "kind = \"pleated\"\nlength = \"47 mm\"\nradius = \"33 mm\"\nfibres = 24\nfibre = { stiffness = \"0.5 kN\" }\n\
         effects = { lobes = { circumference = \"234 mm\" } }\n",
    ),
    (
        "braid of soft fibres",
        "kind = \"braided\"\nlength = \"200 mm\"\nradius = \"10 mm\"\nbraid_angle = \"25 deg\"\nends = \"clamped\"\nfibres = 60\n\
         fibre = { stiffness = \"57 N\" }\n",
    ),
    (
        "long braid of soft fibres and rubber",
        "kind = \"braided\"\nlength = \"500 mm\"\nradius = \"5.5 mm\"\nbraid_angle = \"20 deg\"\nends = \"clamped\"\nwall = \"0.5 mm\"\n\
         fibres = 60\nfibre = { stiffness = \"30 N\" }\neffects = { bladder-elasticity = { c10 = \"20 kPa\" } }\n",
    ),
];
