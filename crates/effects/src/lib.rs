//! The catalogue of physical effects of pneumatic muscles: equations, parameters, sources, signatures and laws.
