// Made from spec/view.schema.json by `npm run types`; a test compares it.

/** One run of a test, ready to be replayed. Times are whole numbers of ticks, lengths in metres where nothing else is said. */
export interface ViewDocument {
  /** Where a generated test comes from, in the words of the test. */
  because?: string | null;
  /** At which lines of the robot's code each thread of its programs was; none if nobody measured it. */
  code?: CodeTrack[];
  contacts?: ContactTrack[];
  /** When the run ended. */
  end: number;
  ended: ViewEnd;
  /** Why the run broke off. */
  error?: string | null;
  /** In the order in which they happened. */
  events?: ViewEvent[];
  /** The files of the robot's code. Those without text may be among the shared assets of the page. */
  files?: ViewSourceFile[];
  /** `hrdsl-view` */
  format: string;
  /** The version of hrdsl that made it. */
  hrdsl?: string;
  /** Positions of joints, each with its limits: rad or m. */
  joints?: SignalTrack[];
  /** What programs wrote, in order. */
  log?: ViewLogLine[];
  machines?: MachineTrack[];
  /** What could not be shown, a sentence each. */
  notes?: string[];
  /** Of bodies that move. A body without a track stays where it starts. */
  poses?: PoseTrack[];
  requirements?: ViewRequirement[];
  scenario: string;
  scene?: ViewScene;
  seed?: number | null;
  /** Signals of the scenario, and what else can be plotted. */
  signals?: SignalTrack[];
  /** The test that was run; left out if the recording says none. */
  test?: string | null;
  /** The length of a tick in nanoseconds. */
  tick: number;
  topics?: TopicTrack[];
  /** The version of the format, 1. */
  version: number;
}

/** What a body belongs to. It decides its colour, and whether it may be cut away. */
export type BodyKind = "robot" | "person" | "thing" | "room";

/** At which line of the robot's code a thread was when: where it asked for something, told something, or began to wait. It is there until the next. */
export interface CodeTrack {
  /** The places of the files: differences. */
  file: number[];
  /** The lines, from 1: differences; 0 while the thread is in none of the files. */
  line: number[];
  /** The program, as the scenario names it. */
  program: string;
  /** Differences. */
  t: number[];
  /** The name of the thread: `MainThread` */
  thread: string;
  /** Since when nobody looked any more. */
  until?: number | null;
}

/** Two bodies that touch each other, and how hard. */
export interface ContactTrack {
  /** The places of the two bodies among the bodies. */
  bodies: [number, number];
  /** x, y, z of the force on the first of the two, in hundredths of a newton: differences. Three zeros end the contact. */
  f: number[];
  /** x, y, z of the point in the world, in tenths of a millimetre: differences. */
  p: number[];
  /** Differences. */
  t: number[];
}

/** What kind of event it is. */
export type EventKind = "stimulus" | "said" | "seen" | "commanded";

/** How values lie to the limit where the requirement is content. */
export type LimitRelation = "<" | "<=" | ">" | ">=";

/** How grave a line of the log is. */
export type LogLevel = "debug" | "info" | "warning" | "error";

/** A state machine of the system, or an automaton: in which state it was. */
export interface MachineTrack {
  actor?: string | null;
  name: string;
  /** By which outcome it left the state before, if it says so. */
  outcome?: (string | null)[];
  /** Which, as a place in `states`; −1 if it is in none from then on. Not as differences. */
  state: number[];
  /** The labels of its states, and of what it can end with. */
  states: string[];
  /** When it came to a state: differences. */
  t: number[];
}

/** An axis of the world. */
export type MeasureAxis = "x" | "y" | "z";

/** What a measure is. */
export type MeasureKind = "distance" | "range" | "angle" | "tilt" | "height" | "coordinate" | "offset" | "way" | "speed" | "force" | "signal";

/** What messages are to a name of the middleware. */
export type MessageRole = "message" | "request" | "answer" | "feedback";

/** How an obligation ended. */
export type ObligationOutcome = "met" | "violated" | "pending" | "dropped";

/** Two points over time, interpolated like poses. */
export interface PointPairs {
  /** x, y, z in the world in tenths of a millimetre: differences. */
  a: number[];
  b: number[];
  /** Differences. */
  t: number[];
}

/** Where a body was: places at some times. Between two, the place is interpolated linearly and the orientation along the shortest arc; before the first and after the last it stays. */
export interface PoseTrack {
  /** The place of the body among the bodies. */
  body: number;
  /** x, y, z of each time in tenths of a millimetre: differences from the time before. */
  p: number[];
  /** x, y, z, w of each time in ten-thousandths: differences from the time before. Left out if it never turns. */
  q?: number[];
  /** Differences. */
  t: number[];
}

/** Scans, each in force until the next. */
export interface ScanTrack {
  /** Of each scan one number a beam, in centimetres: −1 if nothing was met, −2 if something was too near. From the second scan on they are differences from the scan before. */
  ranges: number[];
  /** Differences. */
  t: number[];
}

/** What several runs of a page share: it is stored once. */
export interface SharedAssets {
  /** The text of files of the robot's code, by their names. */
  files?: Record<string, string>;
  meshes?: Record<string, ViewMesh>;
}

/** A unit in which numbers are shown. */
export interface ShownUnit {
  /** How large it is, in the unit in which the value is. */
  size: number;
  /** Such as `cm`. */
  symbol: string;
}

/** What kind of values a signal has. */
export type SignalKind = "bool" | "int" | "float" | "enum";

/** A value over time. */
export interface SignalTrack {
  /** Whose it is; it decides beside whom it is listed. */
  actor?: string | null;
  /** The least and the greatest value that it may have, in its unit. */
  limits?: [number, number] | null;
  /** Whether values between two samples lie on a line. Otherwise each is in force until the next. */
  linear?: boolean;
  name: string;
  /** What a whole number stands for, such as 0.0001; 1 without it. */
  scale?: number | null;
  /** Whether it is what a sensor says: it is then shown among the sensors. */
  sensor?: boolean;
  /** Differences. */
  t: number[];
  type: SignalKind;
  /** Such as `m` or `rad/s`. */
  unit?: string | null;
  /** Differences from the value before; of an enumeration the places in `values`, of a bool 0 or 1. `null` is no value, and the next is the difference from the last that was one. */
  v: (number | null)[];
  /** The names of an enumeration's values. */
  values?: string[];
}

/** Which way messages go, as the robot's code sees it. */
export type TopicDirection = "in" | "out";

/** A topic, service or action of the middleware, with the messages of one role that go one way. */
export interface TopicTrack {
  direction: TopicDirection;
  /** Such as `sensor_msgs/LaserScan`. */
  interface?: string | null;
  name: string;
  /** A topic's, if it is left out. */
  role?: MessageRole | null;
  /** When the messages were: differences. */
  t: number[];
  /** What they say, shortened; `null` where nobody kept it. May be shorter than `t`. */
  text?: (string | null)[];
}

/** A rigid body. */
export interface ViewBody {
  /** Whose body it is: an actor of the scenario. */
  actor?: string | null;
  /** `#rrggbb`, if its description gives it a colour. */
  color?: string | null;
  /** Collides with nothing: it is drawn faintly. */
  ghost?: boolean;
  kind: BodyKind;
  /** As the scenario calls it: `robot.palm`. */
  name: string;
  /** At the start, in the world. */
  pose: [number, number, number, number, number, number, number];
  shapes: ViewShape[];
}

/** What has to be so, as far as it is told. */
export type ViewCondition = {
  is: "all";
  of: ViewCondition[];
} | {
  is: "any";
  of: ViewCondition[];
} | {
  is: "measure";
  measure: number;
} | {
  is: "fact";
  /** It must not be so. */
  negated?: boolean;
  /** The signal that is true while it is so. */
  signal?: string | null;
  /** As the scenario has it. */
  text: string;
} | {
  is: "window";
  negated?: boolean;
  /** Its operands. */
  of: ViewCondition[];
  /** The signal that is true while it holds. */
  signal?: string | null;
  /** As the scenario has it: `historically[0 s, 2 s]`. */
  text: string;
} | {
  event: string;
  /** It tells it once that has lasted for so many seconds. */
  held?: number | null;
  is: "told";
  of: ViewCondition[];
};

/** How a run ended. */
export type ViewEnd = "quiescent" | "limit" | "error";

/** Something that happened. */
export interface ViewEvent {
  /** Who made it. */
  actor?: string | null;
  /** Its arguments as text: `gaze: true, legs: 2`. */
  args?: string | null;
  kind: EventKind;
  name: string;
  /** Which step of the recording it is, counted from 0: line `step` + 2 of the file. */
  step?: number | null;
  t: number;
  /** Until when it went on, if it takes time. */
  until?: number | null;
}

/** A laser scanner. Its beams lie in the level plane of its pose; an angle of 0 is along x, and angles grow to the left. */
export interface ViewLaser {
  /** Of the first beam and of the last, in radians. */
  angles: [number, number];
  beams: number;
  /** The place of its body among the bodies. */
  body: number;
  name: string;
  /** In the body's frame. */
  pose: [number, number, number, number, number, number, number];
  /** The least and the greatest distance that it sees, in metres. */
  range: [number, number];
  /** What it saw. Without it, the page works out what a perfect one would have seen, and says so. */
  scans?: ScanTrack | null;
}

/** What a program wrote. */
export interface ViewLogLine {
  level: LogLevel;
  program?: string | null;
  t: number;
  text: string;
}

/** A value that a requirement compares with a limit. It is as it should be where value, relation and limit make a true sentence. */
export interface ViewMeasure {
  /** Of a way, a coordinate and an offset: along which axes; all of them, if there are none. */
  axes?: MeasureAxis[];
  /** The places of the bodies that it is about among the bodies. */
  bodies?: number[];
  kind: MeasureKind;
  /** In the signal's unit. */
  limit: number;
  /** As the scenario has it: `distance(person.hand, robot.palm)`. If a signal has this name, its values are those of the measure. */
  name: string;
  /** Of an offset: where the place is along each of the axes, in metres; from a second body, where it is beside that. */
  place?: number[];
  /** The two nearest points. Without them the page works them out from the shapes. */
  points?: PointPairs | null;
  relation: LimitRelation;
  /** The unit in which the scenario writes the limit: values are read in it. */
  shown?: ShownUnit | null;
  /** The requirement is about this event, which the world tells when the value is no longer as it should be. */
  tells?: string | null;
  unit?: string | null;
  /** Of a way, and of a speed: the way of how many seconds is drawn. */
  within?: number | null;
}

/** A triangle mesh. */
export interface ViewMesh {
  /** x, y, z of each point, in tenths of a millimetre; not as differences. */
  points: number[];
  /** Three numbers of points for each triangle, anticlockwise as seen from outside. */
  triangles: number[];
}

/** Something that had to happen, or must not, for a while. */
export interface ViewObligation {
  /** By when it had to be met. */
  deadline?: number | null;
  /** When it was made. */
  from: number;
  outcome: ObligationOutcome;
  /** What made it: `decided(ready: true)`. */
  trigger?: string | null;
  /** When it was decided; left out if it never was. */
  until?: number | null;
}

/** A requirement, and how this run fared by it. */
export interface ViewRequirement {
  /** The condition is asked only when one of these events happens; at any time, if there are none. */
  at?: string[];
  /** How the measures, and what else is asked for, make it up; left out if it asks for its one measure, or nothing is known. */
  condition?: ViewCondition | null;
  /** The events that it reads, by name. */
  events?: string[];
  /** Such as `R5`. */
  id: string;
  /** `safety` or `functional`. */
  kind?: string | null;
  /** The least margin, in `unit`. */
  margin?: number | null;
  /** What it judges, as far as it can be drawn. */
  measures?: ViewMeasure[];
  /** The condition is what meets an obligation: that it is not so, is no violation. */
  meets?: boolean;
  obligations?: ViewObligation[];
  /** The signals that it reads, by name. */
  signals?: string[];
  /** As the scenario has it. */
  text?: string | null;
  title?: string | null;
  /** When it was triggered: differences. */
  triggers?: number[];
  unit?: string | null;
  verdict: ViewVerdict;
  /** All violations, in order. */
  violations?: ViewViolation[];
}

/** What there is to be seen. */
export interface ViewScene {
  bodies: ViewBody[];
  lasers?: ViewLaser[];
  /** Meshes that shapes name. One that is not here may be among the shared assets of the page. */
  meshes?: Record<string, ViewMesh>;
}

/** A shape of a body, with its pose in the body's frame; without one it is at the origin. */
export type ViewShape = {
  kind: "box";
  pose?: [number, number, number, number, number, number, number] | null;
  /** The full lengths of the edges. */
  size: [number, number, number];
} | {
  kind: "sphere";
  pose?: [number, number, number, number, number, number, number] | null;
  radius: number;
} | {
  kind: "cylinder";
  length: number;
  pose?: [number, number, number, number, number, number, number] | null;
  radius: number;
} | {
  kind: "capsule";
  length: number;
  pose?: [number, number, number, number, number, number, number] | null;
  radius: number;
} | {
  /** The full lengths of the box that encloses it, for a placeholder. */
  extent?: [number, number, number] | null;
  kind: "mesh";
  /** Its name among the meshes of the scene, or among the shared assets of the page. If it is in neither, a placeholder is drawn. */
  mesh: string;
  pose?: [number, number, number, number, number, number, number] | null;
  scale?: [number, number, number] | null;
};

/** A file of the robot's code. */
export interface ViewSourceFile {
  /** The CRC-32 of its bytes when it ran. */
  crc?: number | null;
  name: string;
  text?: string | null;
}

/** What the run says of a requirement. */
export type ViewVerdict = "pass" | "fail" | "vacuous" | "inconclusive" | "error";

/** A violation. */
export interface ViewViolation {
  /** When the violated obligation was made. */
  since?: number | null;
  /** The steps of the recording that bear it out. */
  steps?: number[];
  t: number;
  /** In a sentence. */
  text: string;
  /** Of a formula: when it holds again. */
  until?: number | null;
}
