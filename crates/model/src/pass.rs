//! Passes over the rows: each carries as many derivatives as there are lanes.

use bulge_effects::{Jet, LANES};

use crate::evaluate::Wanted;

/// The variable that each lane carries in one pass.
pub(crate) struct Pass {
    pub(crate) theta: Vec<Jet>,
    pub(crate) pressure_lane: Option<usize>,
    pub(crate) contraction_lane: Option<usize>,
    /// Lane of each shape parameter.
    pub(crate) shape_lanes: Vec<Option<usize>>,
    /// (lane, place among the wanted parameters)
    pub(crate) columns: Vec<(usize, usize)>,
}

impl Pass {
    /// As many passes as the variables take, in the order pressure and contraction if wanted, then the parameters.
    pub(crate) fn all(theta: &[f64], wanted: &Wanted, shapes: &[usize]) -> Vec<Self> {
        let readings = if wanted.readings { 2 } else { 0 };
        let all = readings + wanted.parameters.len();
        let mut passes = Vec::new();
        for first in (0..all.max(1)).step_by(LANES) {
            let lane_of = |variable: usize| {
                (variable >= first && variable < first + LANES && variable < all).then(|| variable - first)
            };
            let lane = |parameter: usize| {
                let place = wanted.parameters.iter().position(|other| *other == parameter)?;
                lane_of(readings + place)
            };
            let seeded = |(i, value): (usize, &f64)| match lane(i) {
                Some(lane) => Jet::variable(*value, lane),
                None => Jet::from(*value),
            };
            passes.push(Self {
                theta: theta.iter().enumerate().map(seeded).collect(),
                pressure_lane: if wanted.readings { lane_of(0) } else { None },
                contraction_lane: if wanted.readings { lane_of(1) } else { None },
                shape_lanes: shapes.iter().map(|parameter| lane(*parameter)).collect(),
                columns: (0..wanted.parameters.len())
                    .filter_map(|place| lane_of(readings + place).map(|lane| (lane, place)))
                    .collect(),
            });
        }
        passes
    }
}
