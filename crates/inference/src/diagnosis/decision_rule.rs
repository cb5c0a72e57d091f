//! The numbers by which a diagnosis decides, in one place, each with its reason and with what set it.
//!
//! Log evidences are natural logarithms. *Suite*: the simulated tests of `validation/hidden-effects`, constants set on seed 1 there; *forms suite*: those with formulas of their
//! own, constants set on 200 tests of seed 21 and never on the seeds that are reported. What only bounds work (numbers of fits, starts, draws, tolerances) stands
//! where the work is done.

/// How a diagnosis decides.
pub(crate) struct DecisionRule {
    /// Chance with which the screen over the catalogue may raise a false alarm. With [`DecisionRule::smooth`] it keeps 97 of 100 tests quiet that hide nothing (suite).
    pub(crate) screen: f64,
    /// Chance with which the smooth test may raise one on the base (suite: quiet sets).
    pub(crate) smooth: f64,
    /// The same where effects are named: to say that they explain everything takes more than to say nothing (suite: wrong names called adequate).
    pub(crate) smooth_beside_names: f64,
    /// Chance with which near replicates may raise one: 1 false alarm in 236 quiet tests of eight noise laws (suite, forms suite).
    pub(crate) near_replicates: f64,
    /// Chance with which a line in the spectrum may raise one: it is asked of each model that explains the rest.
    pub(crate) oscillation: f64,
    /// Chance with which a jump within a sweep may raise one: it is asked of each model that explains the rest, and tails of real noise are heavier than normal ones.
    pub(crate) jump: f64,
    /// Readings scatter about a model if the mean square of their misfit is that many standard deviations beyond 1, and larger than this ratio: noise laws
    /// from few rows are wrong by as much (suite).
    pub(crate) scatters: [f64; 2],

    /// Log evidence from which the first effect is worth naming, and each further one: before any data it is seven times as likely that something is missing in a model of a real
    /// muscle as that nothing is; that a second effect is missing too is no more likely than not.
    pub(crate) worth: [f64; 2],
    /// Log evidence of something that nobody thought of, before any data: one in seven (pilot: it separated better than any other number that was tried).
    pub(crate) something_else: f64,
    /// What a number costs that is twice as large as plausible: as much as a clear effect brings (suite).
    pub(crate) implausible: f64,
    /// Part of what is plausible by which a number may be beyond it and the effect still be what is missing where something remains: right ones were by up to a fifth (forms
    /// suite, seed 71).
    pub(crate) beyond: f64,
    /// Log evidence that an effect of time must bring beyond one of the path alone: the simpler one, if they are as good (suite).
    pub(crate) simpler: f64,

    /// Standard deviations of a form error as parts of the effect, and how likely each is before any data: half of all formulas hold as they are (pilot of the forms
    /// suite; one common size, and no bound, were worse). Larger ones bent the first effect to what a second and third did (36 tests of seed 47).
    pub(crate) form_errors: [(f64, f64); 3],
    /// The same where a form is drawn, and the factor of the largest that a card allows: no rival stands beside it, and real formulas are wrong by as much (page of the pilot:
    /// half of all effects exact, others up to 40 %).
    pub(crate) drawn_errors: [(f64, f64); 5],
    pub(crate) drawn: f64,
    /// An effect that is bent by a larger part of it in whitened coordinates is another effect (forms suite).
    pub(crate) most_bent: f64,
    /// So is one that is bent by more newtons than it has (RMS): where the noise is nearly alike in many rows, newtons may weigh little (forms suite).
    pub(crate) most_bent_newtons: f64,
    /// Part of what form errors bring that doesn't count when hypotheses are put in order: of two that explain as much the one whose formula is nearer (forms suite).
    pub(crate) by_bending: f64,
    /// Part of the log evidence that the formulas must bring as they are: with less the claim rests on the bending, and is none (right names stood above 0.82 in the pilot, wrong
    /// ones up to 0.62).
    pub(crate) exact: f64,
    /// Part of the misfit, as squares, that formulas must explain as they are: below the first several effects are no claim, above the second they are one though something
    /// that nobody thought of does better on top, for what is left is then the error of these formulas (forms suite, seed 61: where nothing known is hidden 0.83 at most,
    /// known effects in a form of their own 0.95 and more).
    pub(crate) by_formulas: [f64; 2],

    /// Part of what a model explains that a further effect must explain where the formulas of the model may be wrong: what explains less mends a formula. Second effects of
    /// the pilot explained 1.3 % and more, those that mended 0.1 to 0.8 %; on the forms suite 2 % did better than 1 %.
    pub(crate) mends: f64,
    /// Unless it leads something that nobody thought of by this log evidence and nothing remains: right ones led by 13 to 24, those that mended by 8 at most (forms suite, 180
    /// tests of seed 47).
    pub(crate) no_bending: f64,
    /// Log evidence of form errors from which another effect is looked for that makes them superfluous: else "A, bent" hides "A and B" (pilot).
    pub(crate) bent: f64,
    /// Log evidence that such an effect must bring.
    pub(crate) superfluous: f64,
    /// Part of the log evidence of the form errors that it may leave.
    pub(crate) less_bent: f64,
    /// Log evidence that a second effect must bring at once to be named with the first (suite: pairs that look like a third).
    pub(crate) pair: f64,
    /// Part of what a model explains that no comparison with something else rests on: no formula, however bent, is nearer to a real effect (forms suite, 300 sigma).
    pub(crate) digits: f64,
    /// Part of the excess of the misfit over chance that may be left where effects are named though something remains (suite: *unknown* beside strong effects).
    pub(crate) left: f64,
    /// Log evidence of a structure that is left below which it takes nothing away from what is named (forms suite).
    pub(crate) weak: f64,

    /// Part of the full scale that the misfit surely has (the lower end of its interval) from which no model is called adequate: where nothing is hidden it is 0 in nearly
    /// all tests (suite).
    pub(crate) surely: f64,
    /// Part of the full scale that the misfit may have (the upper end) from which no model is called adequate beside slow noise: nobody has seen it apart from the misfit that
    /// it explains (suite).
    pub(crate) maybe: f64,
    /// How much larger than the scatter of single readings that noise then is (suite); so much slow noise as a multiple of what the data sheet of the load cell states is
    /// *cannot tell* too: a jump in one sweep passes for it.
    pub(crate) slow: f64,

    /// Rivals whose log evidence is less than this below stay in the class: one in twenty (Kass and Raftery 1995: from 3 on strong).
    pub(crate) rival: f64,
    /// Part of the log evidence of the form errors that is as much as nothing between rivals (pilot).
    pub(crate) rival_bent: f64,
    /// Sigmas by which rivals must differ to be out by evidence alone: one error in a thousand.
    pub(crate) separation: f64,
    /// Unless the data have decided after all: this far below they are out (suite).
    pub(crate) decided: f64,
    /// Effects that differ by less than this many sigmas are the same on these data.
    pub(crate) same: f64,
    /// Log evidence by which a rival must be better to take the place of an effect that was accepted before the others (suite: pairs).
    pub(crate) swap: f64,

    /// Chance that an effect explains the data and is the wrong one all the same, because the right one is not in the catalogue: no catalogue is complete. No claim
    /// is surer than that (suite: calibration).
    pub(crate) incomplete: f64,
    /// How often a claim is right for each further effect that is named beside it (forms suite, seed 71: with plain evidence the confidence is then within 0.05 of the rate).
    pub(crate) further: f64,
    /// How often a level of a claim must be right for it to be the one that is stated: a name that is likelier wrong than right is one of its class. A further effect
    /// of which not even the mechanism is right as often is no claim: something is there, and the data don't say what (forms suite, seeds 61 and 67: of eleven such
    /// names two or three were right).
    pub(crate) decides: f64,
    /// Log evidence over the model without it below which a further effect is no claim, whatever its rivals: the formulas of the others may be wrong by as much (forms suite, seed
    /// 71: of 13 such names ten were wrong).
    pub(crate) seen: f64,
    /// A single effect whose mechanism is right less often than that is no claim either, but a word that the data don't say what is missing (forms suite, seed 71: of four
    /// such names none was right, and two of three false alarms were among them).
    pub(crate) nameless: f64,

    /// Square of the sigmas from the stated geometry beyond which another answer is asked for: of four numbers chance alone gives as much once in 300 times.
    pub(crate) departed: f64,
    /// Usual widths beyond which a number is not doubtful but another muscle's: chance alone gives as much once in 370 times.
    pub(crate) another_muscle: f64,
}

/// The rule of every diagnosis.
pub(crate) const RULE: DecisionRule = DecisionRule {
    screen: 0.03,
    smooth: 0.006,
    smooth_beside_names: 0.01,
    near_replicates: 0.003,
    oscillation: 2e-4,
    jump: 1e-5,
    scatters: [6.0, 1.5],
    worth: [-2.0, 0.0],
    something_else: -2.0,
    implausible: 8.0,
    beyond: 0.25,
    simpler: 0.2,
    form_errors: [(0.0, 0.5), (0.05, 0.12), (0.1, 0.15)],
    drawn_errors: [(0.0, 0.5), (0.05, 0.12), (0.1, 0.15), (0.2, 0.13), (0.4, 0.1)],
    drawn: 4.0,
    most_bent: 0.4,
    most_bent_newtons: 1.0,
    by_bending: 0.1,
    exact: 0.75,
    by_formulas: [0.8, 0.95],
    mends: 0.02,
    no_bending: 10.0,
    bent: 4.0,
    superfluous: 3.0,
    less_bent: 0.5,
    pair: 3.0,
    digits: 0.002,
    left: 0.02,
    weak: 20.0,
    surely: 0.005,
    maybe: 0.03,
    slow: 3.0,
    rival: 3.0,
    rival_bent: 0.02,
    separation: 3.29,
    decided: 6.0,
    same: 1.0,
    swap: 1.0,
    incomplete: 0.1,
    further: 0.9,
    decides: 0.5,
    seen: 13.5,
    nameless: 0.33,
    departed: 16.0,
    another_muscle: 3.0,
};
