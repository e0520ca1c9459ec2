// Questions to the server: of each kind the newest counts, and answers come line by line.

import type { Dimension } from "./numbers.js";

export type Value = number | string;
export type Values = Record<string, Value>;

export interface Refusal {
  readonly key: string | null;
  readonly message: string;
  readonly accepted: string | null;
}

export interface Progress {
  readonly stage: string;
  readonly step: number;
  readonly pillars: number;
  readonly touched: number;
  /** How far the lens has come, of a cycle. */
  readonly way?: {
    readonly loading: boolean;
    readonly indentation_m: number;
    /** About the part of all that is to be solved. */
    readonly share: number;
  };
}

/** What the cells of a floor that sticks are going to be, about. */
export interface ExpectedCells {
  /** Cells under the contact in the critical state. */
  readonly cells: number;
  /** Cells across the free ring round a pillar. */
  readonly across_ring: number;
  /** Whether they take long. */
  readonly many: boolean;
  /** Whether they are so coarse that the figures are orders of magnitude. */
  readonly coarse: boolean;
}

/** Estimated relative errors; null where an error is not estimated yet. */
export interface ErrorEstimate {
  readonly force: number | null;
  readonly indentation: number | null;
  readonly contact_radius: number | null;
  /** Of the critical state. */
  readonly top_contact_radius?: number | null;
}

export interface TransitionSummary {
  readonly method: string;
  readonly regime: "top_first" | "bottom_first";
  readonly surface_fraction: number;
  readonly pitch_m: number;
  readonly critical_force_N: number;
  readonly critical_indentation_m: number;
  readonly critical_contact_radius_m: number;
  readonly top_contact_radius_m: number;
  readonly pillars_in_contact: number;
  readonly pillars_partially_in_contact: number;
  readonly normalized: { force: number; contact_radius: number; indentation: number };
  readonly relative_error_estimate: ErrorEstimate;
  readonly converged: boolean;
  readonly iterations: number;
  readonly wall_time_s: number;
}

/** What the floor bears. */
export interface FloorSummary {
  readonly force_N: number;
  readonly share: number;
  readonly contact_area_m2: number;
  readonly radius_m: number;
  readonly smallest_distance_to_rim_m: number;
  /** Null where two grids differ. */
  readonly patches: number | null;
  readonly cell_m: Point;
  readonly relative_error_estimate: {
    readonly share: number | null;
    readonly contact_area: number | null;
  };
}

export interface PressSummary {
  readonly method: string;
  readonly force_N: number;
  readonly indentation_m: number;
  readonly contact_radius_m: number;
  /** Only where the floor is in contact too. */
  readonly top_contact_radius_m?: number;
  readonly pillars_in_contact: number;
  readonly pillars_partially_in_contact: number;
  readonly smallest_floor_gap_m: number;
  readonly beyond_transition: boolean;
  /** Null before the transition, and past it where the lens goes through the floor. */
  readonly floor: FloorSummary | null;
  readonly relative_error_estimate: ErrorEstimate;
  readonly limits: readonly Limit[];
  readonly converged: boolean;
  readonly wall_time_s: number;
}

export type Point = readonly [number, number];

/** Where the pillars of a lattice stand: (i, j) at `origin + i a + j b`. */
export interface Lattice {
  /** `a` and `b`. */
  readonly vectors_m: readonly [Point, Point];
  readonly origin_m: Point;
  /** The first index and the end along both; null of a lattice without end. */
  readonly range: readonly [number, number] | null;
  /** Indices of the pillars in view that are missing, one after the other. */
  readonly missing: readonly number[];
}

/** The cells of the floor in contact, in an array of cells. */
export interface FloorCells {
  /** By how much the array is turned about the lens axis, counter-clockwise. */
  readonly turned_rad: number;
  /** Lower left corner of the array from the lens axis, before it is turned. */
  readonly corner_m: Point;
  readonly cell_m: Point;
  readonly columns: number;
  readonly rows: number;
  /** Row, first column and number of cells that are side by side, one after the other. */
  readonly segments: readonly number[];
  /** A letter for the pressure on every cell, from `a`, the smallest pressures, to `z`, the largest; where the floor pulls from `A` to `Z`. */
  readonly shades: string;
  readonly largest_pressure_Pa: number;
  /** The largest pull that is shaded, which is negative; 0 of a floor that does not stick. */
  readonly largest_pull_Pa: number;
}

/** A state, with what is needed to draw it. */
export interface ContactState {
  /** Whether this is the state by the punch lattice, within a per cent or two of the solution that follows, or on the
   * pillar tops alone, where the floor takes longer. */
  readonly approximate: boolean;
  readonly fraction: number;
  readonly summary: PressSummary;
  /** The reduced variables F gamma_int/(h d), a/e and zeta/h. */
  readonly normalized: readonly [number, number, number];
  readonly pitch_m: number;
  readonly diameter_m: number;
  readonly lattice: Lattice;
  readonly pillars: readonly number[];
  readonly pillar_forces_N: readonly number[];
  readonly pillar_statuses: string;
  readonly floor_contacts_m: readonly Point[];
  /** Null where the floor bears nothing. */
  readonly floor: FloorCells | null;
  readonly warnings: readonly string[];
}

/** An estimate by the homogenised lattice, which is shown until the contact is solved. */
export interface Preview {
  readonly fraction: number;
  readonly critical_force_N: number;
  readonly critical_indentation_m: number;
  readonly critical_contact_radius_m: number;
  readonly force_N: number;
  readonly contact_radius_m: number;
  readonly pitch_m: number;
  readonly diameter_m: number;
  readonly lattice: Lattice;
}

/** Outlines of both bodies: heights of each at places along x. */
export interface Section {
  readonly x_m: readonly number[];
  readonly lens_m: readonly number[];
  readonly surface_m: readonly number[];
  /** Where the floor is touched in this plane, if it is: x and height. */
  readonly floor_contacts_m: readonly Point[];
  /** Where the floor bears a part: the ends of every piece in contact along x. */
  readonly floor_m: readonly Point[];
}

/** A state of the loading, as curves show it. */
export interface PathState {
  /** The load as a part of the way to the critical state. */
  readonly fraction: number;
  readonly indentation_m: number;
  readonly force_N: number;
  /** What the floor bears of it; null where the lens goes through the floor. */
  readonly floor_force_N: number | null;
  /** a/e and F gamma_int/(h d). */
  readonly normalized: Point;
}

export interface CurvePoint {
  readonly surface_fraction: number;
  readonly force_N: number;
  readonly contact_radius_m: number;
  readonly indentation_m: number;
  readonly normalized: Point;
}

/** A station of a cycle as the lens passes it. */
export interface CurveStation {
  readonly loading: boolean;
  readonly indentation_m: number;
  readonly force_N: number;
}

/** Estimated relative errors of a figure of a cycle: of the numerical solution, and of the model. */
export interface CycleError {
  readonly numerical: number;
  readonly model_fronts: number;
  readonly model_columns: number;
}

/** A condition of the model, and how near a case comes to where it ends. */
export interface Limit {
  readonly name: string;
  readonly value: number;
  /** Null of what only would change the answer. */
  readonly threshold: number | null;
  readonly strained: boolean;
}

export interface CycleStation {
  readonly branch: "loading" | "unloading";
  readonly indentation_m: number;
  readonly force_N: number;
  readonly contact_radius_m: number;
  readonly pillars_in_contact: number;
  readonly pillars_partially_in_contact: number;
}

export interface CycleEvent {
  readonly branch: "loading" | "unloading";
  readonly event: "snap_in" | "growth" | "recession" | "release" | "floor_contact";
  readonly indentation_m: number;
  readonly force_N: number;
}

/** What of a floor that sticks is in contact at a station. */
export interface FloorStation {
  /** The place of the station. */
  readonly station: number;
  readonly indentation_m: number;
  readonly force_N: number;
  /** Negative where the floor pulls. */
  readonly floor_force_N: number;
  /** Null after a jump of which it is not resolved. */
  readonly floor_contact_area_m2: number | null;
  readonly filled_holes: number;
}

/** A floor that sticks, in a cycle. */
export interface StuckFloor {
  readonly force_before_jump_N: number | null;
  /** The state after the jump. */
  readonly jump: FloorStation | null;
  /** The last state with the floor in contact; null if it still is. */
  readonly last: FloorStation | null;
  readonly indentation_after_loss_m: number | null;
  readonly force_after_loss_N: number | null;
  readonly cells_across_ring: number;
  /** Whether cells are so coarse that the figures are orders of magnitude. */
  readonly coarse: boolean;
  /** Estimated relative errors; 1 of what is not known. */
  readonly relative_error_estimate: {
    readonly jump_force: number;
    readonly jump_contact_area: number;
    readonly lost_indentation: number;
  };
  readonly stations: readonly FloorStation[];
}

/** A cycle of loading and unloading with adhesion, as the command `approach --retract` prints it. */
export interface CycleSummary {
  readonly method: string;
  readonly first_contact_indentation_m: number | null;
  readonly first_contact_force_N: number | null;
  readonly critical_force_N: number | null;
  readonly turn_indentation_m: number;
  readonly pull_off_force_N: number | null;
  readonly pull_off_indentation_m: number | null;
  readonly pull_off_pillars_in_contact: number | null;
  readonly last_release_indentation_m: number | null;
  readonly work_of_separation_J: number;
  readonly hysteresis_J: number | null;
  readonly certificate: number | null;
  readonly relative_error_estimate: {
    readonly critical_force: CycleError | null;
    readonly pull_off_force: CycleError | null;
    readonly hysteresis: CycleError | null;
  };
  /** Only of a floor that sticks and was touched. */
  readonly floor?: StuckFloor;
  readonly limits: readonly Limit[];
  readonly stations: readonly CycleStation[];
  readonly events: readonly CycleEvent[];
  readonly warnings: readonly string[];
  readonly converged: boolean;
  readonly wall_time_s: number;
}

/** A cycle that is solved, of which states follow. */
export interface SolvedCycle {
  readonly summary: CycleSummary;
  /** What the critical force would be if nothing stuck. */
  readonly critical_force_without_adhesion_N: number;
  /** Number of the states that follow. */
  readonly states: number;
  /** The largest force on a pillar in all of them, and the largest pull, which is negative. */
  readonly largest_force_N: number;
  readonly largest_pull_N: number;
  readonly pitch_m: number;
  readonly diameter_m: number;
  readonly lattice: Lattice;
}

/** A pillar in contact in part. */
export interface PartialTop {
  /** Its place among the pillars in contact. */
  readonly pillar: number;
  readonly covered: number;
  /** Outline of what is in contact: x and y of its corners from the middle of the top, pillar radii. */
  readonly outline: readonly number[];
}

/** What is in contact at a station of a cycle. */
export interface StationState {
  /** Its place in `stations` of the summary. */
  readonly place: number;
  /** Its place on the way: 0 at first contact, 1 where the lens turns, 2 at the last release. */
  readonly load: number;
  readonly pillars: readonly number[];
  readonly pillar_forces_N: readonly number[];
  readonly parts: readonly PartialTop[];
  readonly floor_contacts_m: readonly Point[];
  /** Null where no floor sticks. */
  readonly floor: FloorCells | null;
  readonly section: Section | null;
}

export interface Texts {
  readonly toml: string;
  readonly command: string;
  readonly python: string;
}

/** A line of an answer. It has exactly one of these. */
export interface Line {
  readonly progress?: Progress;
  readonly refused?: Refusal;
  readonly preview?: Preview;
  readonly critical?: TransitionSummary;
  readonly state?: ContactState;
  /** The summary of the state that came last, now with its errors, and what to be careful about. */
  readonly summary?: PressSummary;
  readonly warnings?: readonly string[];
  readonly case?: Texts;
  readonly section?: Section | null;
  readonly formulas?: {
    readonly method: string;
    readonly small_contact: readonly CurvePoint[];
    readonly large_contact: readonly CurvePoint[];
  };
  readonly homogenised?: readonly CurvePoint[];
  readonly point?: CurvePoint;
  readonly complete?: { readonly largest_surface_fraction: number };
  readonly transition?: readonly Point[];
  readonly path?: PathState;
  readonly expected_cells?: ExpectedCells;
  readonly curve?: readonly CurveStation[];
  readonly cycle?: SolvedCycle;
  readonly station?: StationState;
}

/** What the key table of the program says about a key of a case. */
export interface Key {
  readonly key: string;
  /** The table of the case file that it is in. */
  readonly table: string;
  readonly label: string;
  /** What follows `_` is lowered. */
  readonly symbol: string | null;
  readonly meaning: string;
  /** What it measures; null if it takes a word. */
  readonly dimension: Dimension | null;
  /** The least and the greatest value allowed, as far as that does not depend on other keys. */
  readonly least: number | null;
  readonly greatest: number | null;
  /** The first and the last of its usual values. */
  readonly usual: readonly [number, number] | null;
  readonly whole: boolean;
  /** Whether it is without end unless it is given. */
  readonly endless: boolean;
  /** The words that it can have; none if it takes a number. */
  readonly words: readonly string[];
  /** Its value where it is left out; null if it must be given. */
  readonly default: Value | null;
  /** The key that it takes the place of. */
  readonly alternative: string | null;
  /** The key that must have one of these words for this key to be given. */
  readonly goes_with: { readonly key: string; readonly words: readonly string[] } | null;
}

export interface Start {
  readonly version: string;
  readonly case: Values;
  /** The paper's intermediate case. */
  readonly paper: Values;
  readonly keys: readonly Key[];
  readonly colours: readonly (readonly [number, number, number])[];
  readonly farthest_load: number;
}

/** Questions that are asked once all others are answered. */
export type Background = "curves" | "phase";

export type Kind = "contact" | Background;

/** Where questions go: with adhesion the place of a contact is taken by a cycle. */
export type ApiPath = Kind | "cycle" | "export";

/** A request was refused, or the server did not answer. */
export class Refused extends Error {
  constructor(readonly refusal: Refusal) {
    super(refusal.message);
  }
}

/** The server that the page is from. */
export class Server {
  private readonly token = location.pathname.split("/")[1] ?? "";
  /** The name of this page among others of the same server. */
  private readonly session = Array.from(crypto.getRandomValues(new Uint8Array(8)), (byte) =>
    byte.toString(16).padStart(2, "0"),
  ).join("");
  private readonly running = new Map<Kind | "export", AbortController>();
  private sequence = 0;

  /** Fetches what the page begins with. */
  async start(): Promise<Start> {
    return (await (await fetch("start.json")).json()) as Start;
  }

  /** Calls off a question, on the server too. */
  cancel(kind: Kind | "export"): void {
    this.running.get(kind)?.abort();
    this.running.delete(kind);
  }

  /** Asks a question. `listen` is called with every line as it comes. False if a newer question took its place. */
  async ask(
    kind: Kind,
    path: ApiPath,
    question: object,
    listen: (line: Line) => void,
  ): Promise<boolean> {
    const controller = this.begin(kind);
    try {
      const response = await this.post(path, question, controller.signal);
      if (response === null || response.body === null) return false;
      const reader = response.body.pipeThrough(new TextDecoderStream()).getReader();
      let rest = "";
      for (;;) {
        const { value, done } = await reader.read();
        if (done) break;
        const lines = (rest + value).split("\n");
        rest = lines.pop() ?? "";
        for (const text of lines) {
          const line = JSON.parse(text) as Line;
          if (line.refused) throw new Refused(line.refused);
          listen(line);
        }
      }
      return true;
    } catch (error) {
      if (controller.signal.aborted) return false;
      throw error;
    } finally {
      if (this.running.get(kind) === controller) this.running.delete(kind);
    }
  }

  /** Asks for a file; null if another was asked for meanwhile. */
  async file(question: object): Promise<Blob | null> {
    const controller = this.begin("export");
    try {
      const response = await this.post("export", question, controller.signal);
      return response === null ? null : await response.blob();
    } catch (error) {
      if (controller.signal.aborted) return null;
      throw error;
    }
  }

  private begin(kind: Kind | "export"): AbortController {
    this.cancel(kind);
    const controller = new AbortController();
    this.running.set(kind, controller);
    return controller;
  }

  /** The answer; null if a newer question took its place. */
  private async post(
    path: ApiPath,
    question: object,
    signal: AbortSignal,
  ): Promise<Response | null> {
    this.sequence += 1;
    const ticket = { session: this.session, sequence: this.sequence };
    let response: Response;
    try {
      response = await fetch(`/api/${path}`, {
        method: "POST",
        headers: { "content-type": "application/json", "x-fakir-token": this.token },
        body: JSON.stringify({ ticket, ...question }),
        signal,
      });
    } catch (error) {
      if (signal.aborted) throw error;
      throw new Refused({
        key: null,
        message: "fakir does not answer",
        accepted: "start `fakir explore` again; it prints a new address",
      });
    }
    if (response.ok) return response;
    if (response.status === 409) return null;
    throw new Refused((await response.json()) as Refusal);
  }
}
