//! Quantities with a dimension: one newtype each, SI inside, constructors and readers named by unit.

use crate::dimension::Dimension;
use crate::units::Quantity;
use serde::Serialize;
use std::fmt;

/// A value in a unit of `factor` SI units, in SI.
///
/// Decimal fractions of the SI unit divide by the exact inverse, so that 5 um is the same number as `5e-6`.
#[must_use]
pub const fn to_si(value: f64, factor: f64) -> f64 {
    if let Some(inverse) = whole_inverse(factor) { value / inverse } else { value * factor }
}

/// An SI value in a unit of `factor` SI units: the inverse of [`to_si`].
pub(crate) const fn in_unit(si: f64, factor: f64) -> f64 {
    if let Some(inverse) = whole_inverse(factor) { si * inverse } else { si / factor }
}

/// The inverse of a factor such as 1e-12. A double holds it exactly where it does not hold the factor.
const fn whole_inverse(factor: f64) -> Option<f64> {
    let inverse = 1.0 / factor;
    let whole = inverse.round();
    // The factor and the division are each rounded once.
    let is_whole = whole >= 1.0 && (inverse - whole).abs() <= 2.0 * f64::EPSILON * whole;
    if is_whole { Some(whole) } else { None }
}

macro_rules! quantity {
    (
        $(#[$doc:meta])*
        $type:ident: $name:literal $dimension:ident, such as $example:literal, shown in $shown:literal ($shown_factor:expr);
        $($make:ident, $read:ident = $factor:expr, [$($symbol:literal),+];)+
    ) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Serialize)]
        pub struct $type(f64);

        impl $type {
            $(
                #[doc = concat!("From a number of ", $($symbol, " ",)+ "(", stringify!($factor), " SI).")]
                #[must_use]
                pub const fn $make(value: f64) -> Self {
                    Self(to_si(value, $factor))
                }

                #[doc = concat!("As a number of ", $($symbol, " ",)+ "(", stringify!($factor), " SI).")]
                #[must_use]
                pub const fn $read(self) -> f64 {
                    in_unit(self.0, $factor)
                }
            )+
        }

        impl Quantity for $type {
            const NAME: &'static str = $name;
            const DIMENSION: Dimension = Dimension::$dimension;
            const EXAMPLE: &'static str = $example;
            const SHOWN: (&'static str, f64) = ($shown, $shown_factor);
            const UNITS: &'static [(&'static str, f64)] = &[$($(($symbol, $factor)),+),+];

            fn from_si(value: f64) -> Self {
                Self(value)
            }

            fn si(self) -> f64 {
                self.0
            }
        }

        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                let value = in_unit(self.0, $shown_factor);
                let digits = f.precision();
                let value = if digits.is_none() { $crate::digits::rounded(value, 12) } else { value };
                write!(f, "{} {}", $crate::digits::plain(value, digits), $shown)
            }
        }
    };
}

quantity! {
    /// A length; SI unit m.
    ///
    /// ```
    /// use bulge_muscles::Length;
    /// let length = Length::mm(110.0);
    /// assert_eq!(length.to_m(), 0.11);
    /// assert_eq!(length.to_string(), "110 mm");
    /// assert_eq!(format!("{:.1}", Length::inch(1.0)), "25.4 mm");
    /// ```
    Length: "length" LENGTH, such as "110 mm", shown in "mm" (1e-3);
    m, to_m = 1.0, ["m"];
    cm, to_cm = 1e-2, ["cm"];
    mm, to_mm = 1e-3, ["mm"];
    um, to_um = 1e-6, ["um"];
    inch, to_inch = 0.0254, ["in", "inch"];
}

quantity! {
    /// A pressure, gauge unless said otherwise; SI unit Pa.
    Pressure: "pressure" PRESSURE, such as "2 bar", shown in "bar" (1e5);
    pa, to_pa = 1.0, ["Pa"];
    hpa, to_hpa = 100.0, ["hPa"];
    kpa, to_kpa = 1e3, ["kPa"];
    mpa, to_mpa = 1e6, ["MPa"];
    gpa, to_gpa = 1e9, ["GPa"];
    bar, to_bar = 1e5, ["bar"];
    mbar, to_mbar = 100.0, ["mbar"];
    // lbf/in^2 = 4.4482216152605 N / (0.0254 m)^2
    psi, to_psi = 4.448_221_615_260_5 / (0.0254 * 0.0254), ["psi"];
}

quantity! {
    /// A force; SI unit N.
    Force: "force" FORCE, such as "500 N", shown in "N" (1.0);
    n, to_n = 1.0, ["N"];
    mn, to_mn = 1e-3, ["mN"];
    kn, to_kn = 1e3, ["kN"];
    meganewton, to_meganewton = 1e6, ["MN"];
    // The international avoirdupois pound (0.45359237 kg) and the kilogram under standard gravity
    // 9.80665 m/s^2.
    lbf, to_lbf = 4.448_221_615_260_5, ["lbf"];
    kgf, to_kgf = 9.806_65, ["kgf"];
}

quantity! {
    /// A plane angle; SI unit rad.
    Angle: "angle" NONE, such as "25 deg", shown in "deg" (std::f64::consts::PI / 180.0);
    rad, to_rad = 1.0, ["rad"];
    mrad, to_mrad = 1e-3, ["mrad"];
    deg, to_deg = std::f64::consts::PI / 180.0, ["deg"];
}

quantity! {
    /// An area; SI unit m^2.
    Area: "area" AREA, such as "0.3 mm^2", shown in "mm^2" (1e-6);
    m2, to_m2 = 1.0, ["m^2", "m2"];
    cm2, to_cm2 = 1e-4, ["cm^2", "cm2"];
    mm2, to_mm2 = 1e-6, ["mm^2", "mm2"];
    um2, to_um2 = 1e-12, ["um^2", "um2"];
}

quantity! {
    /// A volume; SI unit m^3.
    Volume: "volume" VOLUME, such as "400 ml", shown in "ml" (1e-6);
    m3, to_m3 = 1.0, ["m^3", "m3"];
    l, to_l = 1e-3, ["l", "L"];
    cl, to_cl = 1e-5, ["cl", "cL"];
    ml, to_ml = 1e-6, ["ml", "mL"];
    cm3, to_cm3 = 1e-6, ["cm^3", "cm3"];
    mm3, to_mm3 = 1e-9, ["mm^3", "mm3"];
}

quantity! {
    /// A force per length, such as the hoop stiffness E t of a cloth or the stiffness of a frame; SI unit
    /// N/m.
    LineStiffness: "stiffness per width" LINE_STIFFNESS, such as "81 kN/m", shown in "kN/m" (1e3);
    n_per_m, to_n_per_m = 1.0, ["N/m"];
    kn_per_m, to_kn_per_m = 1e3, ["kN/m"];
    mn_per_m, to_mn_per_m = 1e6, ["MN/m"];
    n_per_mm, to_n_per_mm = 1e3, ["N/mm"];
    kn_per_mm, to_kn_per_mm = 1e6, ["kN/mm"];
}

quantity! {
    /// A pure number, such as a contraction; the only quantity that may be written without a unit.
    Ratio: "ratio" NONE, such as "20 %", shown in "%" (1e-2);
    one, to_one = 1.0, [""];
    percent, to_percent = 1e-2, ["%"];
    permille, to_permille = 1e-3, ["permille"];
    ppm, to_ppm = 1e-6, ["ppm"];
}

quantity! {
    /// A time; SI unit s.
    Time: "time" TIME, such as "10 s", shown in "s" (1.0);
    s, to_s = 1.0, ["s"];
    ms, to_ms = 1e-3, ["ms"];
    us, to_us = 1e-6, ["us"];
    min, to_min = 60.0, ["min"];
    h, to_h = 3600.0, ["h"];
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rounding of the last bit: the value and the expectation are each rounded once.
    #[track_caller]
    fn close(found: f64, expected: f64) {
        assert!((found - expected).abs() <= 2.0 * f64::EPSILON * expected.abs(), "{found} is not {expected}");
    }

    #[test]
    fn each_constructor_gives_si() {
        for (found, expected) in [
            (Length::m(2.0).si(), 2.0),
            (Length::cm(2.0).si(), 0.02),
            (Length::mm(110.0).si(), 0.11),
            (Length::um(5.0).si(), 5e-6),
            (Length::inch(2.0).si(), 0.0508),
            (Pressure::pa(30.0).si(), 30.0),
            (Pressure::hpa(1.0).si(), 100.0),
            (Pressure::kpa(200.0).si(), 2e5),
            (Pressure::mpa(0.2).si(), 2e5),
            (Pressure::gpa(70.0).si(), 70e9),
            (Pressure::bar(2.0).si(), 2e5),
            (Pressure::mbar(20.0).si(), 2e3),
            (Pressure::psi(1.0).si(), 6_894.757_293_168_361),
            (Force::n(4.0).si(), 4.0),
            (Force::mn(4.0).si(), 0.004),
            (Force::kn(12.0).si(), 12e3),
            (Force::meganewton(0.49).si(), 0.49e6),
            (Force::lbf(1.0).si(), 4.448_221_615_260_5),
            (Force::kgf(50.0).si(), 490.3325),
            (Angle::rad(0.4).si(), 0.4),
            (Angle::mrad(5.0).si(), 0.005),
            (Angle::deg(180.0).si(), std::f64::consts::PI),
            (Area::m2(1.0).si(), 1.0),
            (Area::cm2(3.0).si(), 3e-4),
            (Area::mm2(0.3).si(), 0.3e-6),
            (Area::um2(7.0).si(), 7e-12),
            (Volume::m3(1.0).si(), 1.0),
            (Volume::l(0.4).si(), 0.4e-3),
            (Volume::cl(1.0).si(), 1e-5),
            (Volume::ml(400.0).si(), 400e-6),
            (Volume::cm3(400.0).si(), 400e-6),
            (Volume::mm3(400.0).si(), 400e-9),
            (LineStiffness::n_per_m(80.0).si(), 80.0),
            (LineStiffness::kn_per_m(80.0).si(), 80e3),
            (LineStiffness::mn_per_m(1.0).si(), 1e6),
            (LineStiffness::n_per_mm(80.0).si(), 80e3),
            (LineStiffness::kn_per_mm(10.0).si(), 10e6),
            (Ratio::one(0.2).si(), 0.2),
            (Ratio::percent(20.0).si(), 0.2),
            (Ratio::permille(3.0).si(), 0.003),
            (Ratio::ppm(3.0).si(), 3e-6),
            (Time::min(1.5).si(), 90.0),
        ] {
            close(found, expected);
        }
    }

    #[test]
    fn readers_undo_constructors() {
        macro_rules! undo {
            ($($type:ident: $($make:ident $read:ident),+;)+) => {$($(
                for value in [1.0, -0.3, 7.25, 1e-9, 123_456.789] {
                    close($type::$make(value).$read(), value);
                }
            )+)+};
        }
        undo! {
            Length: m to_m, cm to_cm, mm to_mm, um to_um, inch to_inch;
            Pressure: pa to_pa, hpa to_hpa, kpa to_kpa, mpa to_mpa, gpa to_gpa, bar to_bar, mbar to_mbar, psi to_psi;
            Force: n to_n, mn to_mn, kn to_kn, meganewton to_meganewton, lbf to_lbf, kgf to_kgf;
            Angle: rad to_rad, mrad to_mrad, deg to_deg;
            Area: m2 to_m2, cm2 to_cm2, mm2 to_mm2, um2 to_um2;
            Volume: m3 to_m3, l to_l, cl to_cl, ml to_ml, cm3 to_cm3, mm3 to_mm3;
            LineStiffness: n_per_m to_n_per_m, kn_per_m to_kn_per_m, mn_per_m to_mn_per_m, n_per_mm to_n_per_mm,
                kn_per_mm to_kn_per_mm;
            Time: s to_s, ms to_ms, us to_us, min to_min, h to_h;
            Ratio: one to_one, percent to_percent, permille to_permille, ppm to_ppm;
        }
    }

    #[test]
    fn decimal_units_are_the_literal() {
        // Bit for bit: a number typed in mm must equal the same number typed in m.
        for i in 1..1000_u32 {
            let value = f64::from(i);
            let literal = |exponent: &str| format!("{i}e{exponent}").parse::<f64>().unwrap().to_bits();
            assert_eq!(Length::mm(value).si().to_bits(), literal("-3"));
            assert_eq!(Length::um(value).si().to_bits(), literal("-6"));
            assert_eq!(Volume::mm3(value).si().to_bits(), literal("-9"));
            assert_eq!(Area::um2(value).si().to_bits(), literal("-12"));
            assert_eq!(Pressure::bar(value).si().to_bits(), literal("5"));
        }
    }

    #[test]
    fn shown_in_the_natural_unit() {
        assert_eq!(Length::um(300.0).to_string(), "0.3 mm");
        assert_eq!(Pressure::kpa(250.0).to_string(), "2.5 bar");
        assert_eq!(Force::kn(3.0).to_string(), "3000 N");
        assert_eq!(Angle::deg(25.0).to_string(), "25 deg");
        assert_eq!(Area::mm2(0.3).to_string(), "0.3 mm^2");
        assert_eq!(Volume::l(0.4).to_string(), "400 ml");
        assert_eq!(LineStiffness::n_per_mm(81.0).to_string(), "81 kN/m");
        assert_eq!(Ratio::one(0.2).to_string(), "20 %");
        assert_eq!(format!("{:.2}", Ratio::one(1.0 / 3.0)), "33.33 %");
    }

    #[test]
    fn constructors_are_constant_and_values_ordered() {
        const R: Length = Length::mm(16.0);
        assert!(R < Length::cm(2.0));
        assert_eq!(R, Length::m(0.016));
    }

    #[test]
    fn serialised_as_the_si_number() {
        assert_eq!(toml::Value::try_from(Pressure::bar(2.0)).unwrap(), toml::Value::Float(2e5));
    }
}
