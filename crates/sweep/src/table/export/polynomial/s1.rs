//! Comparison of Tables 1 and 2 of S1 with the model.

use bulge_fibre::{Approach, Problem};
use bulge_muscles::{Parameter, Pressure, preset};
use serde::Serialize;

use super::fit::{Fitted, fit, value};
use super::{BAR, MILLILITRES, PapersPolynomial, S1_LENGTH, fitted};
use crate::table::export::ExportError;

/// S1 Table 1: f4, f3, f2, f1, f0.
pub(super) const TABLE_1: [f64; 5] = [-2.0413, 171.623, -7178.93, 128_611.6, 146_099.0];
/// S1 Table 2: v5, v4, v3, v2, v1, v0.
pub(super) const TABLE_2: [f64; 6] = [0.022_54, -2.6296, 113.82, -2386.3, 30_080.0, 71_728.0];
/// Contractions that the paper calls practical \[%\].
const PRACTICAL: [f64; 2] = [5.0, 35.0];
/// Radii that the paper names \[mm\].
const RADII_MM: [f64; 2] = [16.0, 11.5];
/// Upper ends of the ranges that are tried \[%\], besides the contraction limit, and the lower ends.
const HIGHS: [f64; 4] = [35.0, 36.0, 38.5, 40.0];
const LOWS: [f64; 3] = [0.0, 1.0, 5.0];
/// Numbers of points that are tried for the fit; the paper doesn't state its number.
const COUNTS: [u32; 3] = [16, 41, 401];

/// Force per pressure at a contraction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ForceRow {
    /// Contraction \[%\].
    pub percent: f64,
    /// Eq. 31 with Table 1 \[N/bar\] at 110 mm.
    pub printed: f64,
    /// Eq. 28 with R = 16 mm, n = 40 \[N/bar\].
    pub computed: f64,
    /// Printed minus computed \[N/bar\].
    pub difference: f64,
}

/// Table 1 compared with the model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ForceTable {
    /// From 5 to 35 % in steps of 2.5 %.
    pub rows: Vec<ForceRow>,
    /// Largest |difference| from 5 to 35 % \[N/bar\].
    pub largest: f64,
    /// Its root mean square \[N/bar\].
    pub rms: f64,
    /// f4 to f0 fitted to the printed curve itself.
    pub refit: [f64; 5],
    /// Largest relative difference of these coefficients from the printed ones.
    pub refit_error: f64,
    /// Eq. 31 fitted to the computed curve from 5 to 35 %, with eq. 32.
    pub of_model: PapersPolynomial,
}

/// Volume at a contraction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct VolumeRow {
    /// Contraction \[%\].
    pub percent: f64,
    /// Eq. 32 with Table 2 \[ml\] at 110 mm.
    pub printed: f64,
    /// Computed with R = 16 mm and with R = 11.5 mm \[ml\].
    pub computed: [f64; 2],
}

/// One hypothesis on how Table 2 was fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VolumeSetting {
    /// Radius \[mm\].
    pub radius_mm: f64,
    /// Contractions \[%\].
    pub range_percent: [f64; 2],
    /// Number of equally spaced points, including both ends.
    pub points: u32,
    /// v5 to v0.
    pub volume: [f64; 6],
    /// Root mean square of the relative differences from the printed coefficients.
    pub from_coefficients: f64,
    /// Largest difference from the printed curve from 0 to 35 % \[ml\] at 110 mm.
    pub from_curve: f64,
}

/// Table 2 compared with the model.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct VolumeTable {
    /// From 0 to 40 % in steps of 5 %.
    pub rows: Vec<VolumeRow>,
    /// All hypotheses, the one with the nearest coefficients first.
    pub settings: Vec<VolumeSetting>,
    /// Index in `settings` of the hypothesis with the nearest curve.
    pub nearest_curve: usize,
    /// Largest differences between the printed curve and the computed ones, for R = 16 mm and 11.5 mm, from 0
    /// to 35 % \[ml\].
    pub largest: [f64; 2],
}

/// Tables 1 and 2 of S1 compared with the model, and the conclusions in words.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct S1Tables {
    /// Table 1.
    pub force: ForceTable,
    /// Table 2.
    pub volume: VolumeTable,
    /// One sentence for each table.
    pub sentences: [String; 2],
}

/// Compares Tables 1 and 2 of S1 with the closed form: l0 = 110 mm, n = 40, R = 16 mm and 11.5 mm.
///
/// Table 1 was fitted to measurements that are not printed as numbers, so only its curve can be compared.
/// Table 2 was fitted to computed volumes, but the range of the fit is not stated, so several ranges are
/// tried.
///
/// # Errors
/// If the shipped muscle or an equilibrium isn't found. Neither happens.
pub fn s1_tables() -> Result<S1Tables, ExportError> {
    let force = force_table()?;
    let volume = volume_table()?;
    let sentences = [force_sentence(&force), volume_sentence(&volume)];
    Ok(S1Tables { force, volume, sentences })
}

/// The paper's muscle with a radius in mm.
struct Curve {
    problem: Problem,
    fibres: Option<u32>,
    radius_mm: f64,
}

impl Curve {
    fn new(radius_mm: f64) -> Result<Self, ExportError> {
        let muscle = preset("ppam-2-r16")?;
        let muscle = muscle.with(Parameter::Radius, radius_mm * 1e-3)?;
        let (problem, fibres) = (Problem::new(&muscle, Pressure::pa(BAR))?, muscle.fibres());
        Ok(Self { problem, fibres, radius_mm })
    }

    /// F \[N\] at 1 bar and V \[m^3\].
    fn at(&self, percent: f64) -> Result<[f64; 2], ExportError> {
        if percent <= 0.0 {
            // This is the straight tube, whose force is infinite.
            let radius = self.radius_mm * 1e-3;
            return Ok([f64::INFINITY, std::f64::consts::PI * radius * radius * S1_LENGTH]);
        }
        let found = self.problem.follow(percent / 100.0, Approach::ClosedForm)?;
        Ok([found.force_n, found.volume_m3])
    }

    fn limit_percent(&self) -> Result<f64, ExportError> {
        Ok(100.0 * self.problem.contraction_limit(Approach::ClosedForm)?)
    }
}

fn steps([from, to]: [f64; 2], count: u32) -> impl Iterator<Item = f64> {
    (0..count).map(move |i| from + (to - from) * f64::from(i) / f64::from(count - 1))
}

fn force_table() -> Result<ForceTable, ExportError> {
    let curve = Curve::new(RADII_MM[0])?;
    let square = S1_LENGTH * S1_LENGTH;
    let row = |percent: f64| {
        let printed = square * value(&TABLE_1, percent) / percent;
        let [computed, _] = curve.at(percent)?;
        Ok::<_, ExportError>(ForceRow { percent, printed, computed, difference: printed - computed })
    };
    let rows = steps(PRACTICAL, 13).map(row).collect::<Result<Vec<_>, _>>()?;
    let fine = steps(PRACTICAL, 601).map(row).collect::<Result<Vec<_>, _>>()?;
    let largest = fine.iter().map(|row| row.difference.abs()).fold(0.0, f64::max);
    let squares: f64 = fine.iter().map(|row| row.difference * row.difference).sum();
    // Converted to forces in N at 3 bar and back, to check that form and units are as the paper states them.
    let measured: Vec<[f64; 2]> =
        fine.iter().map(|row| [row.percent, row.percent * (3.0 * row.printed) / (3.0 * square)]).collect();
    let refit: Fitted<5> = fit(&measured, PRACTICAL);
    let off = |(found, printed): (&f64, f64)| (found / printed - 1.0).abs();
    let fibres = curve.fibres;
    let factor = fibres.map_or(1.0, |n| {
        let turn = std::f64::consts::TAU / f64::from(n);
        turn.sin() / turn
    });
    let dimensionless = |percent: f64| {
        let [force, volume] = curve.at(percent)?;
        Ok([force / (BAR * square * factor), volume / S1_LENGTH.powi(3)])
    };
    Ok(ForceTable {
        rows,
        largest,
        rms: (squares / fine.len() as f64).sqrt(),
        refit: refit.coefficients,
        refit_error: refit.coefficients.iter().zip(TABLE_1).map(off).fold(0.0, f64::max),
        of_model: fitted(dimensionless, Some(S1_LENGTH / (RADII_MM[0] * 1e-3)), fibres, PRACTICAL)?,
    })
}

fn volume_table() -> Result<VolumeTable, ExportError> {
    let curves = [Curve::new(RADII_MM[0])?, Curve::new(RADII_MM[1])?];
    let cube = S1_LENGTH.powi(3);
    let printed = |percent: f64| cube * value(&TABLE_2, percent);
    let row = |percent: f64| {
        let ml = |curve: &Curve| curve.at(percent).map(|[_, volume]| volume * MILLILITRES);
        let computed = [ml(&curves[0])?, ml(&curves[1])?];
        Ok::<_, ExportError>(VolumeRow { percent, printed: printed(percent), computed })
    };
    let rows = steps([0.0, 40.0], 9).map(row).collect::<Result<Vec<_>, _>>()?;
    let mut largest = [0.0_f64; 2];
    for percent in steps([0.0, 35.0], 701) {
        let row = row(percent)?;
        for (largest, computed) in largest.iter_mut().zip(row.computed) {
            *largest = largest.max((row.printed - computed).abs());
        }
    }
    let mut settings = vec![];
    for curve in &curves {
        let limit = curve.limit_percent()?;
        for from in LOWS {
            for to in HIGHS.into_iter().chain([limit]) {
                for points in COUNTS {
                    settings.push(setting(curve, [from, to], points)?);
                }
            }
        }
    }
    settings.sort_by(|a, b| a.from_coefficients.total_cmp(&b.from_coefficients));
    let by_curve = |(_, a): &(usize, &VolumeSetting), (_, b): &(usize, &VolumeSetting)| {
        a.from_curve.total_cmp(&b.from_curve)
    };
    let nearest_curve = settings.iter().enumerate().min_by(by_curve).map_or(0, |(i, _)| i);
    Ok(VolumeTable { rows, settings, nearest_curve, largest })
}

fn setting(curve: &Curve, range: [f64; 2], points: u32) -> Result<VolumeSetting, ExportError> {
    let cube = S1_LENGTH.powi(3);
    let at = |percent: f64| curve.at(percent).map(|[_, volume]| [percent, volume * MILLILITRES / cube]);
    let computed = steps(range, points).map(at).collect::<Result<Vec<_>, _>>()?;
    let volume = fit::<6>(&computed, range).coefficients;
    let squares: f64 =
        volume.iter().zip(TABLE_2).map(|(found, printed)| (found / printed - 1.0).powi(2)).sum();
    let off = |percent: f64| cube * (value(&volume, percent) - value(&TABLE_2, percent)).abs();
    Ok(VolumeSetting {
        radius_mm: curve.radius_mm,
        range_percent: range,
        points,
        volume,
        from_coefficients: (squares / 6.0).sqrt(),
        from_curve: steps([0.0, 35.0], 141).map(off).fold(0.0, f64::max),
    })
}

fn force_sentence(table: &ForceTable) -> String {
    let difference = |percent: f64| {
        let row = table.rows.iter().find(|row| (row.percent - percent).abs() < 1e-9);
        row.map_or(f64::NAN, |row| row.difference)
    };
    format!(
        "Table 1 (fitted to measurements) lies {:+.0} N/bar at 5 %, {:+.0} at 10 %, {:+.0} at 20 % and {:+.0} at 35 % from the closed form with \
         R = 16 mm, at most {:.0} and {:.0} N/bar in the root mean square from 5 to 35 %; fitted to its own curve, eq. 31 gives its coefficients \
         back to a part of {:.0e}, so form and units (N, bar, m, %) are as stated.",
        difference(5.0),
        difference(10.0),
        difference(20.0),
        difference(35.0),
        table.largest,
        table.rms,
        table.refit_error
    )
}

fn volume_sentence(table: &VolumeTable) -> String {
    let (Some(best), Some(curve)) = (table.settings.first(), table.settings.get(table.nearest_curve)) else {
        return String::new();
    };
    let best_of_other =
        table.settings.iter().find(|other| other.radius_mm.to_bits() != best.radius_mm.to_bits());
    let other = best_of_other.map_or(String::new(), |other| {
        let all = table.settings.iter().filter(|s| s.radius_mm.to_bits() == other.radius_mm.to_bits());
        let nearest = all.map(|s| s.from_curve).fold(f64::INFINITY, f64::min);
        format!("; with R = {} mm no range comes nearer than {nearest:.0} ml", other.radius_mm)
    });
    format!(
        "Table 2 comes nearest to a fit of the volumes computed with R = {} mm from {} to {:.1} % ({} points: coefficients {:.1} % apart in the \
         root mean square; nearest curve {:.1} ml apart from 0 to 35 %, {} to {:.1} %){other}. It gives {:.1} ml at rest for {:.1} ml computed, as \
         a polynomial can't follow the steep rise at 0, and is off by at most {:.1} ml up to 35 %.",
        best.radius_mm,
        best.range_percent[0],
        best.range_percent[1],
        best.points,
        100.0 * best.from_coefficients,
        curve.from_curve,
        curve.range_percent[0],
        curve.range_percent[1],
        table.rows.first().map_or(f64::NAN, |row| row.printed),
        table.rows.first().map_or(f64::NAN, |row| row.computed[0]),
        table.largest[0]
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, wanted: f64, by: f64) {
        assert!((found - wanted).abs() <= by, "{found} is not {wanted}");
    }

    #[test]
    fn table_1_beside_the_model() {
        let found = force_table().unwrap();
        let wanted = [
            (5.0, 1524.3, 1438.0),
            (10.0, 1047.3, 994.5),
            (20.0, 540.3, 544.0),
            (30.0, 211.3, 254.0),
            (35.0, 51.3, 137.6),
        ];
        for (percent, printed, computed) in wanted {
            let row = found.rows.iter().find(|row| (row.percent - percent).abs() < 1e-9).unwrap();
            near(row.printed, printed, 0.05);
            near(row.computed, computed, 0.05);
            near(row.difference, row.printed - row.computed, 1e-9);
        }
        near(found.largest, 86.3, 0.05);
        near(found.rms, 44.1, 0.05);
        // Form and units: the printed curve gives the printed digits back.
        assert!(found.refit_error < 1e-11, "{:e}", found.refit_error);
        let of_model = &found.of_model;
        assert_eq!((of_model.slenderness, of_model.fibres), (Some(6.875), Some(40)));
        near(of_model.force_n(1.0, S1_LENGTH, 20.0), 544.02, 1.0);
        near(
            of_model.force_n(3.0, 2.0 * S1_LENGTH, 20.0) / of_model.force_n(1.0, S1_LENGTH, 20.0),
            12.0,
            1e-12,
        );
        near(of_model.volume_ml(S1_LENGTH, 20.0), 376.88, 0.1);
        near(of_model.force_error.largest, 3.13, 0.01);
        near(of_model.volume_error.largest, 0.105, 0.001);
        assert!(of_model.force_error.rms < 0.7 && of_model.force_error.of_full_scale < 0.0022);
        assert!(of_model.condition.iter().all(|c| (1.0..20.0).contains(c)));
    }

    #[test]
    fn table_2_was_fitted_to_the_larger_radius() {
        let found = volume_table().unwrap();
        for (percent, printed, larger, smaller) in
            [(0.0, 95.5, 88.5, 45.7), (20.0, 373.7, 376.9, 293.0), (35.0, 424.8, 430.8, 349.0)]
        {
            let row = found.rows.iter().find(|row| (row.percent - percent).abs() < 1e-9).unwrap();
            near(row.printed, printed, 0.05);
            near(row.computed[0], larger, 0.05);
            near(row.computed[1], smaller, 0.05);
        }
        let best = &found.settings[0];
        assert_eq!((best.radius_mm, best.range_percent, best.points), (16.0, [0.0, 38.5], 16));
        near(best.from_coefficients, 0.0296, 1e-4);
        near(found.settings[found.nearest_curve].from_curve, 3.74, 0.01);
        // The smaller radius is excluded.
        let other = found.settings.iter().filter(|s| s.radius_mm < 12.0);
        assert!(
            other.clone().all(|s| s.from_curve > 85.0 && s.from_coefficients > 0.2) && other.count() == 45
        );
        near(found.largest[0], 12.9, 0.05);
        near(found.largest[1], 87.1, 0.05);
    }

    #[test]
    fn both_in_words() {
        let [force, volume] = s1_tables().unwrap().sentences;
        for part in ["+86 N/bar at 5 %, +53 at 10 %, -4 at 20 % and -86 at 35 %", "at most 86 and 44 N/bar"] {
            assert!(force.contains(part), "{force}");
        }
        for part in [
            "R = 16 mm from 0 to 38.5 %",
            "R = 11.5 mm no range comes nearer than 85 ml",
            "95.5 ml at rest for 88.5 ml",
        ] {
            assert!(volume.contains(part), "{volume}");
        }
        assert!(serde_json::to_string(&s1_tables().unwrap()).unwrap().contains("\"settings\""));
    }
}
