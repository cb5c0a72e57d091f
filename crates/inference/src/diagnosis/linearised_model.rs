//! A model linearised at its best parameters, with the misfit and what each effect of the catalogue could
//! explain of it.

use bulge_effects::Catalogue;
use bulge_model::{ModelError, Record};

use crate::diagnosis::bending::{Kin, bendings, may_bend};
use crate::diagnosis::candidates::Candidate;
use crate::diagnosis::fits::Fits;
use crate::diagnosis::form_error::{FormDirection, FormError};
use crate::diagnosis::jump::{Jump, jump};
use crate::diagnosis::lack_of_fit::lack_of_fit;
use crate::diagnosis::null::{Chance, Null, Statistics};
use crate::diagnosis::oscillation::oscillation;
use crate::diagnosis::sensitivity::Sensitivities;
use crate::diagnosis::smooth::{Variable, smooth};
use crate::diagnosis::space::{Space, orthogonal};
use crate::diagnosis::tangents::Tangents;
use crate::fit::nuisance::Prepared;
use crate::median::median;
use crate::noise::law::NoiseLaw;
use crate::noise::whitening::Whitening;
use crate::progress::{NOBODY, Progress};
use bulge_numerics::vector::{add, dot};

/// Rows whose stated standard deviation exceeds the usual one by this factor count as uncertain.
const DOUBTFUL: f64 = 2.0;
/// Most smooth functions, as a fraction of the effective number of rows.
const PART: f64 = 0.25;

/// Everything that stays the same while models are tried.
#[derive(Clone, Copy)]
pub(crate) struct Context<'a> {
    pub(crate) catalogue: &'a Catalogue,
    /// Means of rows, with their forces.
    pub(crate) record: &'a Record,
    pub(crate) whitening: &'a Whitening,
    /// The noise law of the means.
    pub(crate) law: &'a NoiseLaw,
    /// White noise of a single reading, including input noise that no data sheet states \[N\].
    pub(crate) row_n: f64,
    pub(crate) seed: u64,
    /// Tests only these effects.
    pub(crate) only: Option<&'a [String]>,
    /// Skips the tests of the misfit, because there are no readings or nothing is looked for.
    pub(crate) is_planned: bool,
    /// For drawing forms: form errors may be larger than in comparisons of models.
    pub(crate) to_draw: bool,
    /// Callbacks for the progress.
    pub(crate) progress: &'a Progress,
    /// Columns of kin that are known already.
    pub(crate) kin: Option<&'a Kin>,
    /// Fits that were made already.
    pub(crate) fits: Option<&'a Fits<'a>>,
}

/// A smooth function, orthogonalised against the model's tangents.
#[derive(Debug, Clone)]
pub(crate) struct Direction {
    pub(crate) variable: Variable,
    /// Unit vector in coordinates.
    pub(crate) unit: Vec<f64>,
    /// Change of the force for one standard deviation of its coordinate \[N\].
    pub(crate) values: Vec<f64>,
}

/// A model at its parameters, whitened: its tangents and its misfit. Priors of its parameters are additional
/// rows.
struct Whitened {
    tangent: Tangents,
    priors: usize,
    /// The tangents.
    white: Vec<Vec<f64>>,
    misfit: Vec<f64>,
}

/// A model's misfit and all candidates, in coordinates.
pub(crate) struct LinearisedModel {
    pub(crate) sensitivities: Sensitivities,
    pub(crate) candidates: Vec<Candidate>,
    pub(crate) smooth: Vec<Direction>,
    /// The coordinates.
    pub(crate) space: Space,
    /// Number of priors of parameters and form errors, the last rows of every column.
    pub(crate) priors: usize,
    /// One standard deviation of the offset of each sweep, in coordinates; empty if the law has no offsets.
    pub(crate) offsets: Vec<Vec<f64>>,
    /// Form errors of the model's effects.
    pub(crate) form: FormError,
    /// Form errors of one standard deviation in their principal directions \[N\].
    pub(crate) bent: Vec<Vec<f64>>,
    /// The misfit in coordinates.
    pub(crate) z: Vec<f64>,
    /// The whitened misfit row by row, followed by that of the priors.
    pub(crate) white: Vec<f64>,
    /// Force of the model at the means \[N\].
    pub(crate) force: Vec<f64>,
}

impl<'a> Context<'a> {
    /// A context with white noise as in the law, seed 1 and the whole catalogue.
    pub(crate) fn new(
        catalogue: &'a Catalogue,
        record: &'a Record,
        whitening: &'a Whitening,
        law: &'a NoiseLaw,
    ) -> Self {
        Self {
            catalogue,
            record,
            whitening,
            law,
            row_n: law.white_n,
            seed: 1,
            only: None,
            is_planned: false,
            to_draw: false,
            progress: &NOBODY,
            kin: None,
            fits: None,
        }
    }
}

impl Context<'_> {
    /// A model at parameters `theta`, whitened.
    fn whitened(&self, prepared: &Prepared, theta: &[f64]) -> Result<Whitened, ModelError> {
        let tangent = Tangents::of(prepared, theta, self.record)?;
        let priors: Vec<(usize, f64, f64)> = tangent
            .free
            .iter()
            .enumerate()
            .filter(|(_, i)| prepared.nuisance[**i])
            .filter_map(|(column, i)| {
                prepared.priors[*i].map(|(mean, sd)| (column, (mean - theta[*i]) / sd, 1.0 / sd))
            })
            .collect();
        let rows = self.record.len();
        let mut white: Vec<Vec<f64>> =
            tangent.columns.iter().map(|column| self.white(column, priors.len())).collect();
        let mut misfit = self.white(&tangent.residual, priors.len());
        for (place, (column, misses, slope)) in priors.iter().enumerate() {
            white[*column][rows + place] = *slope;
            misfit[rows + place] = *misses;
        }
        Ok(Whitened { tangent, priors: priors.len(), white, misfit })
    }

    /// A whitened column, with a zero for each of `priors` priors.
    pub(crate) fn white(&self, column: &[f64], priors: usize) -> Vec<f64> {
        let mut white = self.whitening.whitened(column.to_vec());
        white.resize(column.len() + priors, 0.0);
        white
    }

    /// Form errors of a model's effects at parameters `theta`.
    pub(crate) fn form_error(&self, prepared: &Prepared, theta: &[f64]) -> Result<FormError, ModelError> {
        if !may_bend(prepared) {
            return Ok(FormError::default());
        }
        let whitened = self.whitened(prepared, theta)?;
        Ok(self.bent(prepared, theta, &whitened, &Space::without(&whitened.white)).0)
    }

    /// Form errors of one standard deviation in their principal directions, for a model at parameters `theta`
    /// \[N\].
    pub(crate) fn form_directions(&self, prepared: &Prepared, theta: &[f64]) -> Vec<Vec<f64>> {
        let Ok(whitened) = self.whitened(prepared, theta) else { return Vec::new() };
        let (_, bent) = self.bent(prepared, theta, &whitened, &Space::without(&whitened.white));
        bent.into_iter().filter(FormDirection::is_seen).map(|direction| direction.values).collect()
    }

    fn bent(
        &self,
        prepared: &Prepared,
        theta: &[f64],
        whitened: &Whitened,
        space: &Space,
    ) -> (FormError, Vec<FormDirection>) {
        let bendings = bendings(self.catalogue, prepared, theta, &whitened.tangent, self.kin);
        let whiten = |column: &[f64]| self.white(column, whitened.priors);
        FormError::of(&bendings, space, &whitened.misfit, &whiten, self.to_draw)
    }

    /// Linearises a model at parameters `theta`.
    pub(crate) fn linearised(
        &self,
        prepared: &Prepared,
        theta: &[f64],
    ) -> Result<LinearisedModel, ModelError> {
        let mut whitened = self.whitened(prepared, theta)?;
        let mut space = Space::without(&whitened.white);
        let (form, mut bent) = self.bent(prepared, theta, &whitened, &space);
        let whiten = |column: &[f64]| self.white(column, whitened.priors);
        let numbers = prepared.model.parameters();
        let owner: Vec<&str> =
            whitened.tangent.free.iter().map(|index| numbers[*index].effect.as_str()).collect();
        let tangents: Vec<(Vec<f64>, Vec<f64>)> =
            whitened.tangent.columns.iter().cloned().zip(whitened.white).collect();
        let form = form.row_by_row(&bent, &whitened.misfit, &tangents, &owner, &whiten);
        bent.retain(FormDirection::is_seen);
        space.leave_out(&bent.iter().map(|direction| &direction.white[..]).collect::<Vec<_>>());
        let priors = whitened.priors + bent.len();
        let whiten = |column: &[f64]| self.white(column, priors);
        whitened.misfit.resize(self.record.len() + priors, 0.0);
        let tangent = whitened.tangent;
        let sensitivities = Sensitivities::of(self.catalogue, self.only, prepared, theta, &tangent);
        let candidates = Candidate::all(&sensitivities, &mut space, &whiten);
        let smooth = if self.is_planned {
            Vec::new()
        } else {
            let mut known: Vec<(Vec<f64>, Vec<f64>)> = Vec::new();
            for (raw, mut white) in tangents {
                white.resize(self.record.len() + priors, 0.0);
                known.extend(orthogonal(raw, white, &known));
            }
            for (place, direction) in bent.iter().enumerate() {
                let mut white = whiten(&direction.values);
                white[self.record.len() + whitened.priors + place] = 1.0;
                known.extend(orthogonal(direction.values.clone(), white, &known));
            }
            self.directions(known, &mut space, &whiten)
        };
        let directions = bent.into_iter().map(|direction| direction.values).collect();
        let z = space.coordinates(&whitened.misfit);
        let offsets = self.offsets(&space, &whiten);
        Ok(LinearisedModel {
            sensitivities,
            candidates,
            smooth,
            space,
            offsets,
            priors,
            form,
            bent: directions,
            z,
            white: whitened.misfit,
            force: tangent.force,
        })
    }

    fn offsets(&self, space: &Space, whiten: &dyn Fn(&[f64]) -> Vec<f64>) -> Vec<Vec<f64>> {
        if self.law.offset_n <= 0.0 {
            return Vec::new();
        }
        let of = |sweep: &std::ops::Range<usize>| {
            let mut column = vec![0.0; self.record.len()];
            column[sweep.clone()].fill(self.law.offset_n);
            space.coordinates(&whiten(&column))
        };
        self.record.sweeps().iter().map(of).collect()
    }

    /// Smooth functions, the smoothest first, each orthogonalised against those before it and against the
    /// model's tangents and form errors, `known` as orthonormal columns in newtons and whitened.
    fn directions(
        &self,
        mut known: Vec<(Vec<f64>, Vec<f64>)>,
        space: &mut Space,
        whiten: &dyn Fn(&[f64]) -> Vec<f64>,
    ) -> Vec<Direction> {
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of rows")]
        let most = (PART * self.record.len() as f64) as usize;
        let mut found: Vec<Direction> = Vec::new();
        let doubtful = self.doubtful();
        for function in smooth(self.record) {
            if found.len() >= most {
                break;
            }
            let white = whiten(&function.values);
            let Some((values, unit)) = orthogonal(function.values, white, &known) else { continue };
            let mut shown = values.clone();
            for row in &doubtful {
                shown[*row] = 0.0;
            }
            found.push(Direction { variable: function.variable, unit: space.enter(&unit), values: shown });
            known.push((values, unit));
        }
        found
    }

    /// Rows of uncertain direction. They have little weight, so a function isn't determined there.
    fn doubtful(&self) -> Vec<usize> {
        let Some(sd) = self.record.force_sd() else { return Vec::new() };
        let usual = median(&mut sd.to_vec());
        (0..sd.len()).filter(|row| sd[*row] > DOUBTFUL * usual).collect()
    }
}

impl LinearisedModel {
    /// The index of an effect in the list of sensitivities.
    pub(crate) fn place(&self, name: &str) -> Option<usize> {
        self.sensitivities.effects.iter().position(|one| one.effect.card().name == name)
    }

    /// Squared misfit along the smooth functions; its expectation under chance is their number.
    pub(crate) fn structure(&self) -> f64 {
        self.smooth.iter().map(|d| dot(&d.unit, &self.z).powi(2)).sum()
    }

    /// The part of a misfit in coordinates that lies along the smooth functions, row by row \[N\].
    pub(crate) fn systematic(&self, z: &[f64]) -> Vec<f64> {
        let mut sum = vec![0.0; self.force.len()];
        for direction in &self.smooth {
            let part = dot(&direction.unit, z);
            add(&mut sum, part, &direction.values);
        }
        sum
    }

    /// p-value of the common misfit of near replicates; none if there are too few of them.
    pub(crate) fn lack_of_fit(&self, record: &Record) -> Option<f64> {
        lack_of_fit(record, &self.space.outside_of_left_out(&self.white), self.space.left_out())
    }

    /// The period \[s\] of an oscillation in the residuals; none if there is none.
    pub(crate) fn oscillation(&self, context: &Context<'_>) -> Option<f64> {
        let is_slow = context.law.correlated_n > 0.0;
        oscillation(context.record, &self.space.outside_of_left_out(&self.white), is_slow)
    }

    /// A jump within a sweep in the residuals; none if there is none.
    pub(crate) fn jump(&self, context: &Context<'_>) -> Option<Jump> {
        jump(context.record, context.whitening, &self.space, &self.space.outside_of_left_out(&self.white))
    }

    fn units(&self) -> Vec<Vec<f64>> {
        self.smooth.iter().map(|direction| direction.unit.clone()).collect()
    }

    /// The distribution of a right model's misfit.
    pub(crate) fn chance_of<'a>(&'a self, context: &'a Context<'_>) -> Chance<'a> {
        Chance {
            coordinates: self.z.len(),
            freedom: context.law.degrees_of_freedom,
            offsets: &self.offsets,
            offset_n: context.law.offset_n,
            beliefs: &context.law.offset_beliefs,
        }
    }

    /// The null distribution, and the p-values of the screen and of the smooth test.
    pub(crate) fn chance(&self, context: &Context<'_>) -> (Null, [f64; 2]) {
        let units = self.units();
        let found = Statistics::of(&self.z, &self.candidates, &units);
        let chance = self.chance_of(context);
        let null = Null::of(&chance, &self.candidates, &units, context.seed);
        let chance = null.chance(&found);
        (null, chance)
    }
}
