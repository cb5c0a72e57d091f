//! Protocols as files.

use bulge_muscles::units::significant;
use std::fmt::Write;

use crate::protocol::bench::{Block, Path, Protocol, RigErrors};

/// Digits to which numbers are written: 7 % and not 7.000000000000001 %.
const DIGITS: i32 = 12;
/// Units in which numbers are written, with their size in SI.
const BAR: (&str, f64) = (" bar", 1e5);
const PERCENT: (&str, f64) = (" %", 0.01);
const PASCAL: (&str, f64) = (" Pa", 1.0);
const NEWTON: (&str, f64) = (" N", 1.0);
const METRE: (&str, f64) = (" m", 1.0);
const SECOND: (&str, f64) = (" s", 1.0);

impl Protocol {
    /// The protocol as the text of a file. [`Protocol::from_toml`] reads the same protocol back, to 12 digits.
    ///
    /// ```
    /// use bulge_inference::{Block, Protocol};
    /// let text = Protocol::new(vec![Block::loops(vec![2e5, 3e5], [0.01, 0.15], 50.0)]).to_toml();
    /// assert!(text.contains("pressures = [\"2 bar\", \"3 bar\"]\ncontraction = \"1 %..15 %\"\n"), "{text}");
    /// ```
    #[must_use]
    pub fn to_toml(&self) -> String {
        let mut out = String::new();
        if self.rig == RigErrors::Drawn {
            out.push_str("rig = \"drawn\"\n");
        }
        line(&mut out, "pause", self.pause_s, SECOND);
        if self.warming_k != 0.0 {
            line(&mut out, "warming", self.warming_k, (" K", 1.0));
        }
        for block in &self.blocks {
            block.write(&mut out);
        }
        let noise = &self.noise;
        let readings = [
            ("force", noise.force_n, NEWTON),
            ("tails", noise.tails.unwrap_or(0.0), ("", 1.0)),
            ("correlated", noise.correlated_n, NEWTON),
            ("correlation_time", noise.correlation_time_s, SECOND),
            ("offset", noise.offset_n, NEWTON),
            ("pressure", noise.pressure_pa, PASCAL),
            ("length", noise.length_m, METRE),
        ];
        table(&mut out, "noise", &readings);
        let steps = &self.steps;
        let steps = [
            ("force", steps.force_n, NEWTON),
            ("pressure", steps.pressure_pa, PASCAL),
            ("length", steps.length_m, METRE),
        ];
        table(&mut out, "sampling", &steps);
        out
    }
}

impl Block {
    fn write(&self, out: &mut String) {
        out.push_str("\n[[block]]\n");
        let list = |values: &[f64], unit| {
            let texts: Vec<String> =
                values.iter().map(|value| format!("\"{}\"", text(*value, unit))).collect();
            texts.join(", ")
        };
        let range = |[low, high]: [f64; 2], unit| format!("\"{}..{}\"", text(low, unit), text(high, unit));
        let shape = match self.path {
            _ if !self.held.is_empty() => "isometric",
            Path::Triangle | Path::Sine => "loops",
            Path::Stairs { .. } => "stairs",
            Path::Static => "static",
        };
        let _ = writeln!(out, "shape = \"{shape}\"");
        if self.held.is_empty() {
            let _ = writeln!(out, "pressures = [{}]", list(&self.pressures_pa, BAR));
            let _ = writeln!(out, "contraction = {}", range(self.contraction, PERCENT));
        } else {
            let _ = writeln!(out, "contractions = [{}]", list(&self.held, PERCENT));
            let _ = writeln!(out, "pressure = {}", range(self.pressure_range(), BAR));
        }
        match self.path {
            Path::Sine => out.push_str("wave = \"sine\"\n"),
            Path::Stairs { steps, hold_s } => {
                let _ = writeln!(out, "steps = {steps}");
                line(out, "hold", hold_s, SECOND);
            }
            Path::Triangle | Path::Static => {}
        }
        if self.path != Path::Static {
            let _ = writeln!(out, "cycles = {}", self.cycles);
            line(out, "period", self.period_s, SECOND);
        }
        let _ = writeln!(out, "rows = {}", self.rows);
        for (key, count) in [("repeats", self.repeats), ("specimens", self.specimens)] {
            if count != 1 {
                let _ = writeln!(out, "{key} = {count}");
            }
        }
    }
}

/// A table of the numbers that are not 0.
fn table(out: &mut String, name: &str, numbers: &[(&str, f64, (&str, f64))]) {
    let mut stated = numbers.iter().filter(|(_, value, _)| *value != 0.0).peekable();
    if stated.peek().is_some() {
        let _ = writeln!(out, "\n[{name}]");
    }
    for (key, value, unit) in stated {
        line(out, key, *value, *unit);
    }
}

fn line(out: &mut String, key: &str, value: f64, unit: (&str, f64)) {
    let value = text(value, unit);
    // A number without a unit stays a TOML number.
    let _ = if unit.0.is_empty() {
        writeln!(out, "{key} = {value}")
    } else {
        writeln!(out, "{key} = \"{value}\"")
    };
}

/// A number in a unit, without digits left by rounding.
fn text(value: f64, (unit, size): (&str, f64)) -> String {
    let text = significant(value / size, DIGITS);
    let shortest = text.parse::<f64>().map_or(text, |number| format!("{number}"));
    format!("{shortest}{unit}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::bench::{ReadingNoise, ReadingSteps};
    use bulge_numerics::Random;

    fn near(a: &[f64], b: &[f64]) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-11 * a.abs())
    }

    #[test]
    fn what_is_written_is_read_as_the_same() {
        let mut random = Random::new(7, 0);
        for number in 0..200 {
            let mut within = |low: f64, high: f64| random.between(low, high);
            let pressures = (0..=number % 3).map(|_| within(1e3, 9e5)).collect();
            let low = within(-0.1, 0.1);
            let range = [low, low + within(0.01, 0.3)];
            let period = within(30.0, 500.0);
            let block = match number % 5 {
                0 => Block::loops(pressures, range, period),
                1 => Block {
                    path: Path::Sine,
                    cycles: 3,
                    repeats: 2,
                    ..Block::loops(pressures, range, period)
                },
                2 => Block {
                    path: Path::Stairs { steps: 4, hold_s: within(0.1, 3.0) },
                    ..Block::loops(pressures, range, period)
                },
                3 => Block { specimens: 2, ..Block::map(pressures, range, 12) },
                _ => Block::isometric([within(1e4, 1e5), within(2e5, 6e5)], range.to_vec(), period),
            };
            let protocol = Protocol {
                noise: ReadingNoise {
                    force_n: within(0.0, 5.0),
                    tails: (number % 2 == 0).then_some(4.0),
                    offset_n: within(0.0, 1.0),
                    ..ReadingNoise::default()
                },
                steps: ReadingSteps { length_m: within(0.0, 1e-4), ..ReadingSteps::default() },
                rig: if number % 2 == 0 { RigErrors::Drawn } else { RigErrors::None },
                warming_k: within(0.0, 9.0),
                ..Protocol::new(vec![block])
            };
            let text = protocol.to_toml();
            let read = Protocol::from_toml(&text, "written.toml").unwrap_or_else(|e| panic!("{e}\n{text}"));
            let numbers = |p: &Protocol| {
                let block = &p.blocks[0];
                let hold = if let Path::Stairs { hold_s, .. } = block.path { hold_s } else { 0.0 };
                let noise = [p.noise.force_n, p.noise.offset_n, p.steps.length_m, p.warming_k, p.pause_s];
                [&block.pressures_pa[..], &block.contraction, &block.held, &[block.period_s, hold], &noise]
                    .concat()
            };
            assert!(near(&numbers(&protocol), &numbers(&read)), "{protocol:?}\n{text}\n{read:?}");
            let [a, b] = [&protocol, &read].map(|p| {
                let block = &p.blocks[0];
                let shape = std::mem::discriminant(&block.path);
                (shape, block.cycles, block.rows, block.repeats, block.specimens, p.rig, p.noise.tails)
            });
            assert_eq!(a, b, "{text}");
            // JSON is compared too; its parser may change the last digit of a number.
            let json = serde_json::to_string(&protocol).unwrap();
            let read: Protocol = serde_json::from_str(&json).unwrap();
            assert!(near(&numbers(&protocol), &numbers(&read)), "{json}");
        }
    }

    #[test]
    fn numbers_are_written_as_people_write_them() {
        assert_eq!([text(0.07, PERCENT), text(3.5e5, BAR), text(50.0, SECOND)], ["7 %", "3.5 bar", "50 s"]);
        assert_eq!(text(1.0 / 3.0, PERCENT), "33.3333333333 %");
    }
}
