// Questions about cases and their answers, which a server or a module of WebAssembly computes. Of each kind only the newest
// counts; answers arrive line by line.

/** @import { Dimension } from "./numbers.js" */

/** @typedef {number | string} Value */
/** @typedef {Record<string, Value>} Values */

/**
 * @typedef {object} Refusal
 * @property {string | null} key
 * @property {string} message
 * @property {string | null} accepted
 */

/**
 * @typedef {object} Progress
 * @property {string} stage
 * @property {number} step
 * @property {number} pillars
 * @property {number} touched
 * @property {Way} [way] How far the lens has come, of a cycle.
 */

/**
 * Progress of the lens in a cycle.
 * @typedef {object} Way
 * @property {boolean} loading
 * @property {number} indentation_m
 * @property {number} share Approximate fraction of the whole computation.
 */

/**
 * Expected grid on an adhesive floor.
 * @typedef {object} ExpectedCells
 * @property {number} cells Cells under the contact in the critical state.
 * @property {number} across_ring Cells across the free ring around a pillar.
 * @property {boolean} many Whether the computation takes long.
 * @property {boolean} coarse Whether the cells are so coarse that results are orders of magnitude.
 */

/**
 * Estimated relative errors; null where an error is not estimated yet.
 * @typedef {object} ErrorEstimate
 * @property {number | null} force
 * @property {number | null} indentation
 * @property {number} [indentation_m] Error of the indentation, m, with rounded tops.
 * @property {number | null} contact_radius
 * @property {number | null} [top_contact_radius] Only in the critical state.
 */

/**
 * @typedef {object} TransitionSummary
 * @property {string} method
 * @property {"top_first" | "bottom_first"} regime
 * @property {number} surface_fraction
 * @property {number} pitch_m
 * @property {number} critical_force_N
 * @property {number} critical_indentation_m
 * @property {number} critical_contact_radius_m
 * @property {number} top_contact_radius_m
 * @property {number} pillars_in_contact
 * @property {number} pillars_partially_in_contact
 * @property {{ force: number, contact_radius: number, indentation: number }} [normalized] Of flat tops.
 * @property {number} [pillars_fully_in_contact] Of rounded tops.
 * @property {ErrorEstimate} relative_error_estimate
 * @property {boolean} converged
 * @property {number} iterations
 * @property {number} wall_time_s
 */

/**
 * Load and contact on the floor.
 * @typedef {object} FloorSummary
 * @property {number} force_N
 * @property {number} share
 * @property {number} contact_area_m2
 * @property {number} radius_m
 * @property {number} smallest_distance_to_rim_m
 * @property {number | null} patches Null if two grids give different numbers.
 * @property {Point} cell_m
 * @property {{ share: number | null, contact_area: number | null }} relative_error_estimate
 */

/**
 * @typedef {object} PressSummary
 * @property {string} method
 * @property {number} force_N
 * @property {number} indentation_m
 * @property {number} contact_radius_m
 * @property {number} [top_contact_radius_m] Only if the floor is in contact.
 * @property {number} pillars_in_contact
 * @property {number} pillars_partially_in_contact
 * @property {number} [pillars_fully_in_contact] Of rounded tops.
 * @property {number | null} smallest_floor_gap_m
 * @property {boolean} beyond_transition
 * @property {FloorSummary | null} floor Null before the transition, and beyond it if floor contact is ignored.
 * @property {ErrorEstimate} relative_error_estimate
 * @property {FrictionSummary} [friction] Only with shear stresses in the case.
 * @property {readonly Limit[]} limits
 * @property {boolean} converged
 * @property {number} wall_time_s
 */

/**
 * The lateral force of a sliding contact.
 * @typedef {object} FrictionSummary
 * @property {number | null} lateral_force_N Null if the floor is reached and its area is not computed.
 * @property {number | null} floor_share
 * @property {{ lateral_force: number | null }} relative_error_estimate
 */

/** @typedef {readonly [number, number]} Point */

/**
 * Positions of the pillars: pillar (i, j) is at `origin + i a + j b`.
 * @typedef {object} Lattice
 * @property {readonly [Point, Point]} vectors_m The vectors `a` and `b`.
 * @property {Point} origin_m
 * @property {readonly [number, number] | null} range First index and end (exclusive) along both vectors; null for an
 *   infinite lattice.
 * @property {readonly number[]} missing Indices (i, j) of the missing pillars in view, as a flat list.
 * @property {readonly (readonly [number, number, number])[]} [listed] Position and diameter of each pillar of a table, m; pillar (i, 0) is
 *   the i-th.
 */

/**
 * The floor cells in contact, in a rectangular grid.
 * @typedef {object} FloorCells
 * @property {number} turned_rad Rotation of the grid about the lens axis, counter-clockwise.
 * @property {Point} corner_m Lower left corner of the grid relative to the lens axis, before the rotation.
 * @property {Point} cell_m
 * @property {number} columns
 * @property {number} rows
 * @property {readonly number[]} segments Row, first column and length of each run of adjacent cells, as a flat list.
 * @property {string} shades A letter for each cell: `a` (smallest) to `z` (largest) for pressure, `A` to `Z` for
 *   tension.
 * @property {number} largest_pressure_Pa
 * @property {number} largest_pull_Pa Largest tension on the floor, negative; 0 without adhesion on the floor.
 */

/**
 * A contact state with the data to draw it.
 * @typedef {object} ContactState
 * @property {boolean} approximate Whether a more accurate state follows. This one is computed with the punch lattice
 *   (within one or two per cent), or without the floor, which takes longer.
 * @property {number | null} fraction Null for a state on the way to a critical state that is not known yet.
 * @property {PressSummary} summary
 * @property {readonly [number, number, number] | null} normalized Of flat tops, the reduced variables F gamma_int/(h d), a/e and zeta/h.
 * @property {number} pitch_m
 * @property {number} diameter_m
 * @property {Lattice} lattice
 * @property {readonly number[]} pillars
 * @property {readonly number[]} pillar_forces_N
 * @property {string} pillar_statuses
 * @property {readonly (readonly [number, number, number])[]} [contacts_m] Centre and radius of the contact on each of these pillars, m, with
 *   rounded tops.
 * @property {readonly Point[]} floor_contacts_m
 * @property {FloorCells | null} floor Null if the floor carries no load.
 * @property {readonly string[]} warnings
 */

/**
 * An estimate with the homogenised lattice, shown until the contact is solved.
 * @typedef {object} Preview
 * @property {number} fraction
 * @property {number} critical_force_N
 * @property {number} critical_indentation_m
 * @property {number} critical_contact_radius_m
 * @property {number} force_N
 * @property {number} contact_radius_m
 * @property {number} pitch_m
 * @property {number} diameter_m
 * @property {Lattice} lattice
 */

/**
 * Outlines of both bodies: their heights at positions along x.
 * @typedef {object} Section
 * @property {readonly number[]} x_m
 * @property {readonly number[]} lens_m
 * @property {readonly number[]} surface_m
 * @property {readonly Point[]} floor_contacts_m Point contacts with the floor in this plane: x and height.
 * @property {readonly Point[]} floor_m Both ends along x of each part of the floor in contact.
 */

/**
 * A state of the loading, as a point of the curves.
 * @typedef {object} PathState
 * @property {number} fraction Load as a fraction of the way to the critical state.
 * @property {number} indentation_m
 * @property {number} force_N
 * @property {number | null} floor_force_N Floor force, part of `force_N`; null if floor contact is ignored.
 * @property {Point | null} normalized Of flat tops, a/e and F gamma_int/(h d).
 */

/**
 * @typedef {object} CurvePoint
 * @property {number} surface_fraction
 * @property {number} force_N
 * @property {number} contact_radius_m
 * @property {number} indentation_m
 * @property {Point} normalized
 */

/**
 * A load step of a cycle, sent while the cycle is computed.
 * @typedef {object} CurveStation
 * @property {boolean} loading
 * @property {number} indentation_m
 * @property {number} force_N
 */

/**
 * Estimated relative errors of a number of a cycle: of the numerical solution and of the model.
 * @typedef {object} CycleError
 * @property {number} numerical
 * @property {number} model_fronts
 * @property {number} model_columns
 * @property {number} model_corners
 */

/**
 * A validity limit of the model, and the value of the case.
 * @typedef {object} Limit
 * @property {string} name
 * @property {number} value
 * @property {number | null} threshold Null if there is no limit, only an effect on the answer.
 * @property {boolean} strained
 */

/**
 * @typedef {object} CycleStation
 * @property {"loading" | "unloading"} branch
 * @property {number} indentation_m
 * @property {number} force_N
 * @property {number} contact_radius_m
 * @property {number} pillars_in_contact
 * @property {number} pillars_partially_in_contact
 */

/**
 * @typedef {object} CycleEvent
 * @property {"loading" | "unloading"} branch
 * @property {"snap_in" | "growth" | "recession" | "release" | "floor_contact"} event
 * @property {number} indentation_m
 * @property {number} force_N
 */

/**
 * Contact with an adhesive floor at a load step.
 * @typedef {object} FloorStation
 * @property {number} station Index of the load step.
 * @property {number} indentation_m
 * @property {number} force_N
 * @property {number} floor_force_N Negative in tension.
 * @property {number | null} floor_contact_area_m2 Null after a jump if the area is not resolved.
 * @property {number} filled_holes
 */

/**
 * An adhesive floor in a cycle.
 * @typedef {object} AdhesiveFloor
 * @property {number | null} force_before_jump_N
 * @property {FloorStation | null} jump The state after the jump onto the floor.
 * @property {FloorStation | null} last The last state with floor contact; null if the floor does not detach.
 * @property {number | null} indentation_after_loss_m
 * @property {number | null} force_after_loss_N
 * @property {number} cells_across_ring
 * @property {boolean} coarse Whether the cells are so coarse that results are orders of magnitude.
 * @property {{ jump_force: number, jump_contact_area: number, lost_indentation: number }} relative_error_estimate
 *   Estimated relative errors; 1 if unknown.
 * @property {readonly FloorStation[]} stations
 */

/**
 * A cycle of loading and unloading with adhesion, as the command `fakir cycle` prints it.
 * @typedef {object} CycleSummary
 * @property {string} method
 * @property {number | null} first_contact_indentation_m
 * @property {number | null} first_contact_force_N
 * @property {number | null} critical_force_N
 * @property {number} turn_indentation_m
 * @property {number | null} pull_off_force_N
 * @property {number | null} pull_off_indentation_m
 * @property {number | null} pull_off_pillars_in_contact
 * @property {number | null} last_release_indentation_m
 * @property {number} work_of_separation_J
 * @property {number | null} hysteresis_J
 * @property {number | null} certificate
 * @property {{ critical_force: CycleError | null, pull_off_force: CycleError | null, hysteresis: CycleError | null }}
 *   relative_error_estimate
 * @property {AdhesiveFloor} [floor] Only if the floor is adhesive and was touched.
 * @property {readonly Limit[]} limits
 * @property {readonly CycleStation[]} stations
 * @property {readonly CycleEvent[]} events
 * @property {readonly string[]} warnings
 * @property {boolean} converged
 * @property {number} wall_time_s
 */

/**
 * A solved cycle, whose states follow.
 * @typedef {object} SolvedCycle
 * @property {CycleSummary} summary
 * @property {number} critical_force_without_adhesion_N Critical force without adhesion.
 * @property {number} states Number of the states that follow.
 * @property {number} largest_force_N Largest force on a pillar in all states.
 * @property {number} largest_pull_N Largest tension of a pillar in all states, negative.
 * @property {number} pitch_m
 * @property {number} diameter_m
 * @property {Lattice} lattice
 */

/**
 * A pillar in partial contact.
 * @typedef {object} PartialTop
 * @property {number} pillar Its index among the pillars in contact.
 * @property {number} covered
 * @property {readonly number[]} outline Corners (x, y) of the outline of the contact from the centre of the top, in
 *   pillar radii, as a flat list.
 */

/**
 * Contact at a load step of a cycle.
 * @typedef {object} StationState
 * @property {number} place Its index in `stations` of the summary.
 * @property {number} load Position in the cycle: 0 at first contact, 1 where unloading starts, 2 at the last release.
 * @property {readonly number[]} pillars
 * @property {readonly number[]} pillar_forces_N
 * @property {readonly PartialTop[]} parts
 * @property {readonly Point[]} floor_contacts_m
 * @property {FloorCells | null} floor Null without adhesion on the floor.
 * @property {Section | null} section
 */

/**
 * A load on viscoelastic bodies over time.
 * @typedef {object} History
 * @property {HistorySummary} summary
 * @property {readonly number[]} loads The load of each state: of the elastic contact that covers the same area.
 * @property {Texts} case
 */

/**
 * @typedef {object} HistoryState
 * @property {number} time_s
 * @property {number} force_N
 * @property {number} indentation_m
 * @property {number | null} contact_radius_m
 * @property {number | null} floor_share
 */

/**
 * A history as the command `fakir hold` prints it.
 * @typedef {object} HistorySummary
 * @property {readonly HistoryState[]} states
 * @property {HistoryState} end
 * @property {number | null} time_to_floor_contact_s
 * @property {number | null} time_to_equilibrium_s
 * @property {number} instantaneous_modulus_ratio
 * @property {{ force: number, indentation: number }} relative_error_estimate
 * @property {readonly string[]} warnings
 * @property {boolean} converged
 */

/**
 * @typedef {object} Texts
 * @property {string} toml
 * @property {string} command
 * @property {string} python
 */

/**
 * A line of an answer; it has exactly one of these parts, but `warnings`, which come with `summary`.
 * @typedef {object} Line
 * @property {Progress} [progress]
 * @property {Refusal} [refused]
 * @property {Preview} [preview]
 * @property {TransitionSummary} [critical]
 * @property {ContactState} [state]
 * @property {PressSummary} [summary] Summary of the latest state, now with its error estimates.
 * @property {readonly string[]} [warnings]
 * @property {Texts} [case]
 * @property {Section | null} [section]
 * @property {{ method: string, small_contact: readonly CurvePoint[], large_contact: readonly CurvePoint[] }}
 *   [formulas]
 * @property {readonly CurvePoint[]} [homogenised]
 * @property {CurvePoint} [point]
 * @property {{ largest_surface_fraction: number }} [complete]
 * @property {readonly Point[]} [transition]
 * @property {readonly Point[]} [unloading] Indentations, m, and forces, N.
 * @property {{ indentation_m: number, why: string }} [reference] The load 1 where there is no critical state.
 * @property {PathState} [path]
 * @property {ExpectedCells} [expected_cells]
 * @property {readonly CurveStation[]} [curve]
 * @property {SolvedCycle} [cycle]
 * @property {StationState} [station]
 * @property {Measured} [measured]
 * @property {Fitted} [fitted]
 * @property {History} [history]
 * @property {FileContents} [read]
 * @property {SurfaceShown} [surface]
 */

/**
 * What a file contains; of a table of pillars, whether it has heights and diameters.
 * @typedef {{ kind: "heights" } | { kind: "curve" } | { kind: "pillars", height: boolean, diameter: boolean }} FileContents
 */

/**
 * A file that is sent with a question.
 * @typedef {{ name: string, base64: string }} GivenFile
 */

/**
 * The contact of the lens with a height map.
 * @typedef {object} SurfaceShown
 * @property {boolean} approximate Whether the same follows on smaller cells.
 * @property {readonly [number, number]} file_cells
 * @property {readonly [number, number]} cells
 * @property {number} relief_m Range of the heights.
 * @property {number} indentation_m
 * @property {SurfaceSummary} summary
 * @property {number} wall_time_s
 * @property {readonly string[]} warnings
 * @property {readonly [number, number]} drawn Number of drawn cells along x and y.
 * @property {Point} corner_m Lower left corner relative to the lens axis.
 * @property {readonly [number, number]} cell_m
 * @property {string} heights A letter for each cell, in rows from the smallest y on: `a` (lowest) to `z`.
 * @property {string} pressures The same for pressures; a blank without contact.
 * @property {number} largest_pressure_Pa
 * @property {Section} section
 * @property {string} toml
 * @property {string} command
 */

/**
 * The numbers that `fakir press` prints for a height map.
 * @typedef {object} SurfaceSummary
 * @property {number} force_N
 * @property {number} contact_area_m2
 * @property {{ force: number, contact_area: number | null } | null} relative_error_estimate
 */

/**
 * A measured curve as it was read.
 * @typedef {object} Measured
 * @property {string} name
 * @property {"displacement" | "indentation"} position Kind of the position: a displacement includes the contact point.
 * @property {readonly number[]} position_m
 * @property {readonly number[]} force_N
 * @property {readonly boolean[]} unloading
 * @property {readonly string[]} notes How the columns were understood.
 */

/**
 * A fit of the measured curve.
 * @typedef {object} Fitted
 * @property {{ converged: boolean, wall_time_s: number }} summary As `fakir fit --json` prints it.
 * @property {readonly FittedValue[]} estimates
 * @property {number} contact_point_m
 * @property {readonly Point[]} curve
 * @property {readonly Point[]} residuals
 * @property {readonly string[]} warnings
 */

/**
 * A fitted parameter, in SI units.
 * @typedef {object} FittedValue
 * @property {string} name
 * @property {boolean} is_key
 * @property {number} value
 * @property {number | null} standard_error
 */

/**
 * A key of a case, as the key table of the program describes it.
 * @typedef {object} Key
 * @property {string} key
 * @property {string} table Its table in the case file.
 * @property {string} label
 * @property {string | null} symbol The part after `_` is a subscript.
 * @property {string} meaning
 * @property {Dimension | null} dimension Dimension of its value; null if the value is a word.
 * @property {number | null} least Smallest accepted value, unless it depends on other keys.
 * @property {number | null} greatest Largest accepted value, unless it depends on other keys.
 * @property {readonly [number, number] | null} usual Range of usual values.
 * @property {boolean} text Whether it takes any text.
 * @property {boolean} list Whether it takes a list of numbers.
 * @property {boolean} whole
 * @property {string | null} infinite The word for no value, if that is an infinite one: of a thickness or a radius.
 * @property {boolean} on_flat Whether cases with a flat surface have it.
 * @property {readonly string[]} words The words that it accepts; empty if it takes a number.
 * @property {Value | null} default Its default; null if it must be given.
 * @property {string | null} alternative The key that it replaces.
 * @property {{ key: string, words: readonly string[] } | null} goes_with The key that must have one of these words
 *   for this key to be given.
 */

/**
 * @typedef {object} Start
 * @property {string} version
 * @property {Values} case
 * @property {Values} paper The paper's intermediate case.
 * @property {{ map: GivenFile | null, case: Values } | null} surface A `[surface]` to begin with: its file, if it has one, and its own values.
 * @property {GivenFile | null} table The table of pillars of that case.
 * @property {readonly Key[]} keys
 * @property {readonly (readonly [number, number, number])[]} colours
 * @property {number} farthest_load
 */

/**
 * Questions that are sent once all others are answered.
 * @typedef {"curves" | "phase"} Background
 */

/** @typedef {"contact" | Background} Kind */

/**
 * Kinds of questions of which only the newest is answered.
 * @typedef {Kind | "export" | "fit" | "hold" | "read" | "surface"} Asked
 */

/**
 * Names of requests: with adhesion `cycle` replaces `contact`.
 * @typedef {Kind | "cycle" | "export" | "fit" | "hold" | "read" | "surface"} ApiPath
 */

/**
 * Computes answers: the server of this page, or a module in a Web Worker.
 * @typedef {object} Engine
 * @property {() => Promise<Start>} start The initial data of the page.
 * @property {(kind: Asked) => void} cancel Cancels a question.
 * @property {(kind: Asked, path: ApiPath, question: object, listen: (line: Line) => void) => Promise<boolean>} ask Sends
 *   a question, and calls `listen` with each line of the answer. The result is false if a newer question replaced it.
 * @property {(question: object) => Promise<Blob | null>} file Requests a file; null if another was requested in the
 *   meantime.
 */

/** Thrown if a request is refused or cannot be answered. */
export class Refused extends Error {
  /** @type {Refusal} */
  refusal;

  /** @param {Refusal} refusal */
  constructor(refusal) {
    super(refusal.message);
    this.refusal = refusal;
  }
}
