//! The result of a solve, in SI units: plain, serialisable values from which writers (JSON, CSV, VTK, plots)
//! take their data.

use serde::Serialize;

/// How an equilibrium was computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Elliptic integrals (pleated) or the algebraic cylinder (braided, `ends = "cylinder"`).
    ClosedForm,
    /// Shooting on the equilibrium ODE.
    Shooting,
    /// Membrane finite elements (not of this crate).
    Membrane,
}

impl std::fmt::Display for Method {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::ClosedForm => "closed-form",
            Self::Shooting => "shooting",
            Self::Membrane => "membrane",
        })
    }
}

/// How a solve converged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Convergence {
    /// Newton iterations on the two unknowns of the meridian.
    pub iterations: u32,
    /// Evaluations: of the equilibrium ODE's right-hand side, of the integrands where the search takes the
    /// meridian by quadrature (shooting), or of the pair of elliptic integrals (closed form).
    pub evaluations: u32,
    /// Integration steps accepted in the last integration (pieces, if it is a quadrature); 0 for the closed
    /// form.
    pub steps: u32,
    /// Largest relative residual of the end conditions (radius, fibre length, end distance).
    pub residual: f64,
    /// Largest departure from the first integral `N cos(psi) = F + p A(r)` along the meridian, relative to
    /// the largest of these forces.
    pub first_integral: f64,
}

/// One equilibrium without its meridian: what a curve, a fit or a table needs.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Response {
    /// Gauge pressure \[Pa\].
    pub pressure_pa: f64,
    /// Axial force \[N\], tension (pull) positive.
    pub force_n: f64,
    /// Distance between the end fittings \[m\].
    pub length_m: f64,
    /// Contraction (l0 - l)/l0 \[-\].
    pub contraction: f64,
    /// Enclosed volume with circular cross-sections of the fibre radius, plus the pleat depth or less the
    /// wall if there is one. With lobes it is the volume of the lobes \[m^3\].
    pub volume_m3: f64,
    /// Enclosed volume with the cross-section that carries the pressure (polygon between n fibres, or lobes)
    /// \[m^3\]: p dV of it is the work of the gas, and F = -p dV/dl holds where nothing else stores energy.
    pub volume_polygon_m3: f64,
    /// Largest radius of the fibres \[m\].
    pub max_radius_m: f64,
    /// Radius at mid-length \[m\] (differs from the largest one only for a waisted muscle).
    pub mid_radius_m: f64,
    /// Largest tension along a fibre \[N\]; of all fibres together where the muscle file doesn't state their
    /// number.
    pub fibre_tension_n: f64,
    /// Largest axial strain along a fibre \[-\]; 0 for inextensible fibres.
    pub fibre_strain: f64,
    /// dF/dl at constant pressure \[N/m\]: positive when the muscle resists lengthening.
    pub stiffness_n_per_m: f64,
    /// dV/dl at constant pressure \[m^2\], polygon cross-section.
    pub volume_slope_m2: f64,
    /// dF/dl at constant gas amount, isothermal \[N/m\].
    pub stiffness_isothermal_n_per_m: f64,
    /// dF/dl at constant gas amount, adiabatic (exponent 1.4) \[N/m\].
    pub stiffness_adiabatic_n_per_m: f64,
    /// Angle of the meridian against the axis at the fittings \[rad\], positive where the muscle widens from
    /// the fitting.
    pub end_slope_rad: f64,
    /// How it was computed.
    pub method: Method,
    /// How it converged.
    pub convergence: Convergence,
}

impl Response {
    /// Whether the muscle pulls: the force is not negative, except for rounding, which is small against
    /// `scale_n`. (Near the limit the force is small against p R^2.)
    #[must_use]
    pub fn pulls(&self, scale_n: f64) -> bool {
        self.force_n >= -1e-9 * scale_n
    }
}

/// One point of the meridian.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct MeridianPoint {
    /// Distance from the left end fitting along the axis \[m\], 0 ..= length.
    pub x_m: f64,
    /// Radius of the fibres \[m\].
    pub r_m: f64,
    /// Angle of the meridian against the axis, dr/dx = tan(slope) \[rad\]; positive in the left half of a
    /// bulge.
    pub slope_rad: f64,
    /// Angle between fibre and meridian \[rad\].
    pub braid_angle_rad: f64,
    /// Tension of one fibre \[N\] (of all, where their number isn't stated).
    pub fibre_tension_n: f64,
    /// Axial strain of the fibre \[-\].
    pub fibre_strain: f64,
    /// Meridional force per circumference, N/(2 pi r) \[N/m\].
    pub membrane_force_n_per_m: f64,
    /// Unstretched length of fibre from the left fitting \[m\].
    pub fibre_length_m: f64,
    /// Angle about the axis by which the fibre has turned since the left fitting \[rad\]; 0 for straight
    /// fibres.
    pub turn_rad: f64,
}

/// One equilibrium with its meridian.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Shape {
    /// Force, length, volume and the rest.
    #[serde(flatten)]
    pub response: Response,
    /// The meridian from the left fitting to the right one, symmetric about the middle.
    pub meridian: Vec<MeridianPoint>,
}
