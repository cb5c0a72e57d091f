// @ts-check
// What the server's documents hold, as far as the page reads them; their schemas are those of `--json`.

/**
 * @typedef {object} ChosenEffect
 * @property {string} name
 * @property {Record<string, number>} [hold] numbers that are not fitted, in the shown unit of the card
 */

/** @typedef {{file: string, column: string, quantity: string, unit: string | null, first: string[], guessed: boolean, says?: string | null}} ColumnReading */

/**
 * @typedef {object} Reading
 * @property {ColumnReading[]} columns
 * @property {{file: string, row: number, reason: string}[]} set_apart
 * @property {number} set_apart_rows
 * @property {string[]} [notes]
 */

/**
 * @typedef {object} Data what was compared
 * @property {number} rows
 * @property {number} used
 * @property {number} sweeps
 * @property {number} full_scale_n
 * @property {boolean} is_path
 * @property {{says: string, instead: string}[]} findings
 * @property {{rows: number, lines: string, why: string}[]} left_out
 */

/** @typedef {{name: string, toml: string, shipped: string | null}} Muscle */

/**
 * @typedef {object} Session
 * @property {number} revision
 * @property {boolean} can_undo
 * @property {boolean} can_redo
 * @property {{names: string[], rows: number, sha256: string}} data
 * @property {string | null} columns
 * @property {Reading} reading
 * @property {Muscle} muscle
 * @property {ChosenEffect[]} effects
 * @property {string | null} own_effects
 * @property {number[]} excluded
 * @property {View} view
 * @property {{effects: ChosenEffect[], is_current: boolean} | null} diagnosis
 * @property {{error: string, where: string} | null} problem why nothing can be computed
 * @property {string} command
 * @property {string} python
 */

/** @typedef {import("./plots.js").View & {theme?: string, plan?: {blocks: import("./protocol.js").Block[], noise_n: number | null}}} View */

/**
 * @typedef {object} Fitted
 * @property {string} effect
 * @property {string} name
 * @property {string | null} specimen
 * @property {number} value
 * @property {number | null} low
 * @property {number | null} high
 * @property {string} unit
 * @property {string} interval
 * @property {string | null} at_bound
 * @property {boolean} plausible
 * @property {[number, number] | null} plausible_range
 * @property {boolean} determined
 */

/**
 * @typedef {object} Rung
 * @property {string | null} added
 * @property {string} title
 * @property {number} rmse_n
 * @property {number | null} held_out_rmse_n
 * @property {string | null} held_out_by
 * @property {number} r_squared
 * @property {number} fitted
 * @property {number} bias_n
 * @property {{parameters: Fitted[], warnings: string[]} | null} fit
 * @property {string | null} [without_state]
 */

/**
 * @typedef {object} Comparison
 * @property {string} muscle
 * @property {Data} data
 * @property {any[]} quality
 * @property {{sd_n: number | null, source: string, says: string} | null} noise_floor
 * @property {Rung[]} ladder
 * @property {string[]} warnings
 */

/**
 * @typedef {object} Parameter
 * @property {string} name
 * @property {string} about
 * @property {string} unit
 * @property {number} low
 * @property {number} high
 * @property {boolean} logarithmic
 * @property {string | null} multiple_of
 * @property {[number, number] | null} plausible
 * @property {number} typical
 * @property {[string, string] | null} reciprocal
 */

/**
 * @typedef {object} Card
 * @property {string} name
 * @property {string} title
 * @property {string} about
 * @property {string} equation
 * @property {string} source
 * @property {string} stage
 * @property {string} mechanism
 * @property {string} separate
 * @property {{parity?: string, pressure?: string, shape?: string} | null} signature
 * @property {{name: string, how: string}[]} twins
 * @property {Parameter[]} parameters
 * @property {string | null} [unsuitable]
 */

/** @typedef {{effect: string, behind: number | null, separation: number | null}} Rival */

/**
 * @typedef {object} Claim
 * @property {string} effect
 * @property {string} [fitted]
 * @property {string} family
 * @property {string} mechanism
 * @property {string[]} class
 * @property {string[]} [forms]
 * @property {number | null} confidence
 * @property {number | null} [confidence_mechanism]
 * @property {number | null} [confidence_form]
 * @property {{share: number, rms_n: number} | null} [form_error]
 * @property {Record<string, {value: number, unit: string, low: number | null, high: number | null}>} parameters
 * @property {boolean} [plausible]
 * @property {Rival[]} rivals
 */

/**
 * @typedef {object} Diagnosis
 * @property {string} verdict
 * @property {string} says
 * @property {Claim[]} missing
 * @property {Claim[]} [nearest]
 * @property {{added: string | null, bent: boolean, rmse_n: number | null, held_out_rmse_n: number | null, adequate: boolean}[]} ladder
 * @property {{variable: string, share: number, p: number, says: string}[]} where
 * @property {{law?: {says?: string}}} noise
 * @property {{structured: boolean, misfit_n: number, misfit_interval_n: [number, number] | null, hints: any[]}} remaining
 * @property {{says: string, as_stated_rmse_n: number | null}} geometry
 * @property {any[]} not_looked_for
 * @property {{says: string, separates: string[], repeats: number, protocol?: import("./protocol.js").Protocol | null} | null} next_experiment
 * @property {string[]} warnings
 */

/** @typedef {import("./rows.js").Rows} Rows */

/**
 * @typedef {object} Shape
 * @property {number[]} points
 * @property {number[]} triangles
 * @property {{name: string, unit: string, values: number[]}[]} fields
 * @property {number} force_n
 * @property {number} length_m
 * @property {number} radius_m
 * @property {number} contraction
 * @property {number} pressure_pa
 */

export {};
