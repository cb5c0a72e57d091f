//! Parameters fixed, bounded or tied on the command line.

use bulge_inference::{Loss, Options, Statements};
use bulge_measurements::Data;
use bulge_muscles::Muscle;
use clap::Args;

use crate::failure::Failure;

/// What commands that fit take: each option as often as there are numbers.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct RestrictedArguments {
    /// Hold a number at a value: `--hold bladder-elasticity.modulus="0.31 MPa"` (`bulge effects NAME` has the numbers of an effect)
    #[arg(long, value_name = "EFFECT.NUMBER=VALUE")]
    hold: Vec<String>,
    /// Keep a number between two values: `--bound coulomb-friction.force="5..20 N"`
    #[arg(long, value_name = "EFFECT.NUMBER=LOW..HIGH")]
    bound: Vec<String>,
    /// Give a number the value of another one, which is fitted: `--tie force-lag.time=pressure-lag.time`
    #[arg(long, value_name = "EFFECT.NUMBER=EFFECT.NUMBER")]
    tie: Vec<String>,
}

/// How much readings far off count in a fit.
#[derive(Debug, Clone, Default, Args)]
pub(crate) struct LossArgument {
    /// What a reading contributes that lies r standard deviations of the noise off: r^2 (squares), or less than that beyond one or two (huber, soft-l1) or ever
    /// less (cauchy), so that spikes pull less
    #[arg(long, default_value = "squares", value_parser = Loss::ALL.map(Loss::name))]
    loss: String,
}

impl LossArgument {
    pub(crate) fn loss(&self) -> Loss {
        Loss::named(&self.loss).unwrap_or_default()
    }
}

impl RestrictedArguments {
    /// Adds these restrictions to the options of a fit. `muscle` is the muscle that is fitted; its widths
    /// determine the geometry fitted along.
    pub(crate) fn apply(&self, options: Options, data: &Data, muscle: &Muscle) -> Result<Options, Failure> {
        let Self { hold, bound, tie } = self.clone();
        Ok(options.stating(&Statements { hold, bound, tie }, data, muscle)?)
    }

    /// Each option with its value, for a command line.
    pub(crate) fn stated(&self) -> Vec<(&'static str, String)> {
        let all = [("--hold", &self.hold), ("--bound", &self.bound), ("--tie", &self.tie)];
        all.iter().flat_map(|(option, texts)| texts.iter().map(|text| (*option, text.clone()))).collect()
    }
}
