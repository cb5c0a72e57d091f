//! The reference values in `reference/`, included in the program.

use crate::check::Trouble;

/// Pleated muscle, inextensible fibres.
pub(crate) const PLEATED_INELASTIC: &str = include_str!("../reference/pleated_inelastic.csv");
/// Pleated muscle, elastic fibres.
pub(crate) const PLEATED_ELASTIC: &str = include_str!("../reference/pleated_elastic.csv");
/// Braid with clamped ends, force and volume of several geometries.
pub(crate) const CLAMPED_NET: &str = include_str!("../reference/braided_clamped_net.csv");
/// Braid with clamped ends, with tensions and slopes.
pub(crate) const NET_TENSIONS: &str = include_str!("../reference/braided_net_tensions.csv");
/// Braid with a rubber bladder.
pub(crate) const NET_BLADDER: &str = include_str!("../reference/braided_net_bladder.csv");
/// Contractions at which the force of the clamped braid vanishes.
pub(crate) const NET_LIMITS: &str = include_str!("../reference/braided_net_limits.csv");

/// A printed number: its value and one unit of its last digit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Printed {
    pub(crate) value: f64,
    pub(crate) unit: f64,
}

impl Printed {
    fn read(text: &str) -> Result<Self, Trouble> {
        let value = text.parse().map_err(|_| format!("`{text}` in a reference file is not a number"))?;
        let (digits, exponent) = text.split_once('e').unwrap_or((text, "0"));
        let decimals = digits.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        let unit = 10_f64.powi(exponent.parse::<i32>()? - i32::try_from(decimals)?);
        Ok(Self { value, unit })
    }

    /// The part of the relative difference that the printed digits don't explain.
    pub(crate) fn unexplained(&self, got: f64) -> f64 {
        let difference = (got - self.value).abs();
        if difference.is_nan() { difference } else { (difference - self.unit).max(0.0) / self.value.abs() }
    }
}

/// The rows of a reference file with N columns.
pub(crate) fn rows<const N: usize>(text: &str) -> Result<Vec<[Printed; N]>, Trouble> {
    let lines = text.lines().filter(|line| !line.starts_with('#') && !line.trim().is_empty()).skip(1);
    lines
        .map(|line| {
            let row = line.split(',').map(Printed::read).collect::<Result<Vec<_>, _>>()?;
            <[Printed; N]>::try_from(row)
                .map_err(|row| format!("{} columns instead of {N}", row.len()).into())
        })
        .collect()
}

/// Rows of a reference file without the accuracy of their digits.
pub(crate) fn values<const N: usize>(text: &str) -> Result<Vec<[f64; N]>, Trouble> {
    Ok(rows(text)?.into_iter().map(|row| row.map(|printed| printed.value)).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_count() {
        let close = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-12;
        assert!(close(Printed::read("709.026").unwrap().unit, 1e-3));
        assert!(close(Printed::read("1.06211145315e-05").unwrap().unit, 1e-16));
        let printed = Printed::read("-50.1057801").unwrap();
        assert_eq!(printed.unexplained(-50.105_780_15).to_bits(), 0.0_f64.to_bits());
        assert!(printed.unexplained(-50.1058) > 3e-7);
        assert!(printed.unexplained(f64::NAN).is_nan());
        assert!(Printed::read("5O.1").is_err());
    }

    #[test]
    fn files_have_their_columns() {
        assert_eq!(rows::<7>(PLEATED_INELASTIC).unwrap().len(), 59);
        assert_eq!(rows::<9>(PLEATED_ELASTIC).unwrap().len(), 30);
        assert_eq!(rows::<8>(CLAMPED_NET).unwrap().len(), 36);
        assert_eq!(rows::<9>(NET_TENSIONS).unwrap().len(), 16);
        assert_eq!(rows::<5>(NET_BLADDER).unwrap().len(), 14);
        assert_eq!(rows::<3>(NET_LIMITS).unwrap().len(), 2);
        assert!(rows::<6>(NET_BLADDER).is_err());
    }
}
