//! Shape, force and volume of pneumatic artificial muscles: library and command line.
