//! A muscle that senses its contraction: a helical channel of liquid metal in an elastomer layer around it.
//!
//! In S3, "Study on Mechanical Behaviour of Pneumatic Artificial Muscle and Methods to Improve it", section
//! 5, a layer of elastomer outside the fibres has a helical micro-channel filled with eutectic
//! gallium-indium. As the muscle contracts it grows wider, the channel becomes longer and thinner, and its
//! resistance rises. S3 reports a resistance that is highly linear in the contraction, with little
//! hysteresis. It gives no equations; they follow.
//!
//! # Path of the channel
//!
//! S is the unstretched fibre length from the left fitting \[m\], S1 that of the whole muscle, and s = S/S1
//! in \[0, 1\] the material coordinate. The layer is bonded to the fibres: its points keep s and the angle
//! theta about the axis. (Crossings of a braid are pinned; its two families turn in opposite directions, so
//! the crossings keep their azimuth.) The radius r, the slope psi of the meridian, the fibre strain e and the
//! angle alpha between fibre and meridian are functions of s from a [`bulge_fibre::Shape`]:
//!
//! ```text
//! sigma = (1 + e) cos(alpha)                   meridian per unstretched fibre; against rest it is stretched by sigma/cos(alpha0)
//!                                              (pleated: alpha = 0, so 1 + e;  braided: cos(alpha)/cos(alpha0) for inextensible fibres)
//! rho   = r + t cos(psi)                       radius of the channel, t outside the fibres along the normal              [m]
//! a     = sigma - t dpsi/dS                    its meridian per unstretched fibre: the parallel surface is longer by 1 + t kappa,
//!                                              kappa = -(dpsi/dS)/sigma
//! theta' = 2 pi N/((s_b - s_a) S1)             N turns between s_a and s_b                                                [rad/m]
//! dL/dS = sqrt((rho theta')^2 + a^2)           length of the channel                                                       [m/m]
//! ```
//! The change of the meridian by the offset is included. The variation of t along the muscle (see
//! [`Layer::Thinning`]) is neglected in a, an error of the order (dt/dS)^2/2. The section around the fibres
//! is taken as a circle, not as the polygon between them (shorter by pi^2/(6 n^2): 0.1 % for 40 fibres) or as
//! lobes of cloth.
//!
//! # Resistance
//!
//! Liquid and elastomer are incompressible. The index 0 denotes the reference, in which the section is A0
//! everywhere:
//!
//! ```text
//! lambda = dL/dL0          A = A0/lambda          R = int rho_e dL/A = (rho_e/A0) int lambda^2 dL0                          [ohm]
//! R0 = rho_e L0/A0         uniform stretch: R = R0 (L/L0)^2, never more than the above (Cauchy-Schwarz)
//! ```
//! rho_e is the resistivity ([`EGAIN_RESISTIVITY_OHM_M`]). Gauge factor: dR/(R0 de) for the contraction e.
//!
//! # Accuracy
//!
//! Between the points of the meridian r, psi and sigma are polynomials of degree 5 through six of them; a
//! Gauss rule of six points integrates between two neighbours. The error decreases with the sixth power of
//! the spacing, or with the third if the law of a muscle has a kink (cloth that becomes taut).
//!
//! # Results
//!
//! The radius of a pleated muscle grows about as the root of its contraction, so its square is nearly
//! straight, but concave. 20 turns on the middle 40 % of `ppam-2-r16` deviate by 7.0 % of full scale from a
//! line from 5 to 30 %, with a gauge factor of 19.6. The middle is both the most sensitive and the most
//! linear zone. A braid is most linear near its fittings: 0.24 % for a tenth of `dmsp-20-250` from 5 to 25 %,
//! against 3.7 % at its middle.
//!
//! Deliberately absent: leads and contacts (a constant in series), temperature, viscosity of the elastomer
//! (hysteresis), and the contribution of the layer to the force.

mod channel;
mod curve;
mod error;
mod linearity;
mod place;
mod question;
mod sensor;
mod surface;
#[cfg(test)]
mod tests;
mod winding;

pub use channel::{ChannelPoint, Reading};
pub use curve::{Curve, Range, Resolution};
pub use error::SensingError;
pub use linearity::Linearity;
pub use place::{Goal, Place, Placement, Search, Verdict};
pub use question::{RESISTANCE_UNITS, SenseAnswer, SenseDocument, SenseQuestion};
pub use sensor::Sensor;
pub use winding::{EGAIN_RESISTIVITY_OHM_M, Layer, Options, Reference, Winding};
