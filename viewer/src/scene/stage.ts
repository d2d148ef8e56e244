// The pane with the scene: one run, or two side by side under the same camera.

import { ColorManagement, LinearSRGBColorSpace, PerspectiveCamera, Raycaster, Vector2, Vector3, WebGLRenderer } from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { stateAt, type Run } from "../data/run.js";
import type { CameraName, Changed, Part, State, Store } from "../state.js";
import { h, say } from "../ui/dom.js";
import { seconds } from "../ui/text.js";
import { palette } from "../ui/theme.js";
import { Flight, flightLength, hasWalls, shotOf } from "./camera.js";
import { Labels, type Frame } from "./labels.js";
import { RunScene } from "./run-scene.js";

/** Colours are those of the style sheet, on the screen too: nothing is converted for each dot. */
ColorManagement.enabled = false;

/** Still pictures are drawn so finely without a graphics card: more dots, in the place of smoothed edges. */
const STILL = 2;
/** A picture is still when it has not changed for so long, in milliseconds. */
const RESTED = 180;

/** Whether WebGL draws in software. */
function isSoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = String((info && gl?.getParameter(info.UNMASKED_RENDERER_WEBGL)) ?? "");
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

export class Stage implements Part {
  readonly element: HTMLElement;
  private renderer: WebGLRenderer | null = null;
  private readonly camera = new PerspectiveCamera(38, 1, 0.02, 200);
  private controls: OrbitControls | null = null;
  private scenes: RunScene[] = [];
  private readonly labels = new Labels();
  private readonly captions = [h("div", { class: "caption" }), h("div", { class: "caption" })] as const;
  private readonly message = h("p", { class: "nothing", hidden: true });
  private flight: Flight | null = null;
  private followed: Vector3 | null = null;
  private colors = palette();
  private fineness = 1;
  private software = false;
  private resting = 0;
  private still = false;
  private resized = true;
  private width = 0;
  private height = 0;

  constructor(private readonly store: Store) {
    this.element = h("section", { class: "stage", "aria-label": "Scene", tabindex: "0" });
    this.camera.up.set(0, 0, 1);
    try {
      this.software = isSoftware();
      // The stencil keeps shadows on the floor, one dark however many fall on one place.
      this.renderer = new WebGLRenderer({ antialias: !this.software, stencil: true, powerPreference: "high-performance" });
      this.renderer.outputColorSpace = LinearSRGBColorSpace;
      this.renderer.autoClear = false;
      this.renderer.setPixelRatio(this.ratio);
      this.element.append(this.renderer.domElement);
      this.listen(this.renderer.domElement);
    } catch {
      this.fail("This browser shows no 3D: it has no WebGL, or it is switched off. Everything else on this page works without it.");
    }
    this.element.append(this.labels.element, ...this.captions, this.message);
    // Asked for in each frame, the size would cost a layout each time.
    new ResizeObserver(() => {
      this.resized = true;
      store.touch("camera");
    }).observe(this.element);
  }

  private fail(text: string): void {
    say(this.message, text);
    this.message.hidden = false;
  }

  private listen(canvas: HTMLCanvasElement): void {
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault();
      this.fail("The graphics driver has given up on the scene. Reload the page to see it again.");
    });
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.store.schedule());
    this.controls.addEventListener("start", () => (this.flight = null));
    canvas.addEventListener("click", (event) => {
      const name = this.bodyUnder(event);
      this.store.set({ body: name === this.store.state.body ? null : name });
    });
    canvas.addEventListener("dblclick", (event) => {
      const name = this.bodyUnder(event);
      if (name) this.store.set({ body: name, follow: true });
    });
  }

  private bodyUnder(event: MouseEvent): string | null {
    const { left, top } = this.element.getBoundingClientRect();
    const [x, y] = [event.clientX - left, event.clientY - top];
    const at = this.frames().findIndex((f) => x >= f.x && x < f.x + f.width);
    const [frame, scene] = [this.frames()[at], this.scenes[at]];
    if (!frame || !scene) return null;
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2(((x - frame.x) / frame.width) * 2 - 1, 1 - ((y - frame.y) / frame.height) * 2), this.camera);
    const hit = ray.intersectObjects(scene.bodies.group.children, false).find((i) => typeof i.object.userData["body"] === "number" && i.object.type === "Mesh");
    const body = scene.run.bodies[hit?.object.userData["body"] as number];
    return body && body.kind !== "room" ? body.name : null;
  }

  /** Side by side, with a line between. */
  private frames(): Frame[] {
    const count = Math.max(this.scenes.length, 1);
    const width = this.width / count;
    return Array.from({ length: count }, (_, i) => ({ x: Math.round(i * width), y: 0, width: Math.round(width) - (i < count - 1 ? 1 : 0), height: this.height }));
  }

  /** Turns the camera about what it looks at, or goes nearer. */
  orbit(sideways: number, upwards: number, nearer: number): void {
    if (!this.controls) return;
    this.flight = null;
    const offset = this.camera.position.clone().sub(this.controls.target);
    offset.applyAxisAngle(new Vector3(0, 0, 1), sideways);
    const side = new Vector3().crossVectors(new Vector3(0, 0, 1), offset).normalize();
    const tilted = offset.clone().applyAxisAngle(side, upwards);
    if (Math.abs(tilted.clone().normalize().z) < 0.995) offset.copy(tilted);
    this.camera.position.copy(this.controls.target).add(offset.multiplyScalar(1 - nearer));
    this.controls.update();
    this.store.schedule();
  }

  private fly(name: CameraName, state: State, at_once: boolean): void {
    const run = state.runs[0];
    if (!run || !this.controls) return;
    this.flight = new Flight(this.camera, this.controls, shotOf(name, run, state.time, state.focus, this.camera), at_once ? 0 : flightLength());
  }

  /** How finely the scene is drawn while the run plays: what a slow machine needs to keep up. */
  coarsen(fineness: number): void {
    this.fineness = fineness;
  }

  /** Dots of the scene for each of the page. */
  private get ratio(): number {
    if (this.still) return Math.max(STILL, devicePixelRatio);
    return Math.min(devicePixelRatio, this.software ? 1 : 2) * this.fineness;
  }

  private refine(): void {
    if (this.renderer && Math.abs(this.renderer.getPixelRatio() - this.ratio) > 1e-3) this.renderer.setPixelRatio(this.ratio);
  }

  /** Draws the picture once more, finely, when nothing has changed for a while. */
  private rest(state: State): void {
    window.clearTimeout(this.resting);
    if (!this.software || state.playing) return;
    this.resting = window.setTimeout(() => {
      this.still = true;
      for (const scene of this.scenes) scene.bodies.roughen(false);
      this.refine();
      this.render(this.store.state);
    }, RESTED);
  }

  private resize(): void {
    const { clientWidth, clientHeight } = this.element;
    if (clientWidth === this.width && clientHeight === this.height) return;
    [this.width, this.height] = [clientWidth, clientHeight];
    this.renderer?.setSize(this.width, this.height, false);
  }

  update(state: State, changed: Changed): void {
    // Another size empties the picture, so that it is drawn in the same frame.
    if (this.resized || changed.has("runs")) this.resize();
    this.resized = false;
    if (changed.has("runs")) this.replace(state);
    if (changed.has("theme")) this.colors = palette();
    for (const scene of this.scenes) scene.restyle(this.colors, state.lowWalls && hasWalls(scene.run));
    const frame = this.frames()[0];
    if (frame && frame.height > 0) this.camera.aspect = frame.width / frame.height;
    this.camera.updateProjectionMatrix();
    if (changed.has("runs")) this.fly(state.camera, state, true);
    else if (changed.has("camera")) this.fly(state.camera, state, false);
    for (const scene of this.scenes) {
      scene.bodies.roughen(this.software && state.playing);
      scene.update(state);
    }
    this.goAlong(state, changed.has("follow") || changed.has("body"));
    if (this.flight && !this.flight.step(performance.now())) this.flight = null;
    if (this.flight) this.store.schedule();
    this.still = false;
    this.refine();
    this.render(state);
    this.rest(state);
  }

  private replace(state: State): void {
    const kept = this.scenes.filter((scene) => state.runs.includes(scene.run));
    for (const scene of this.scenes) if (!kept.includes(scene)) scene.dispose();
    this.scenes = this.renderer ? state.runs.map((run) => kept.find((s) => s.run === run) ?? new RunScene(run, this.colors, state.lowWalls && hasWalls(run))) : [];
    if (this.renderer) {
      const empty = state.runs.every((run) => run.bodies.length === 0);
      this.message.hidden = !empty;
      if (empty) say(this.message, "This recording has no bodies: there is nothing to draw.");
    }
  }

  /** Moves the camera by as much as the followed body has moved. */
  private goAlong(state: State, anew: boolean): void {
    const scene = this.scenes[0];
    const at = scene && state.follow ? scene.run.bodies.findIndex((b) => b.name === state.body) : -1;
    const pose = at < 0 ? undefined : scene?.bodies.poses[at];
    if (!pose || !this.controls) {
      this.followed = null;
      return;
    }
    const now = new Vector3(pose[0], pose[1], pose[2]);
    const before = anew || !this.followed ? now : this.followed;
    const moved = now.clone().sub(before);
    this.camera.position.add(moved);
    this.controls.target.add(moved);
    this.controls.update();
    this.followed = now;
  }

  private render(state: State): void {
    this.labels.begin();
    const frames = this.frames();
    if (this.renderer) {
      this.renderer.setScissorTest(true);
      this.camera.updateMatrixWorld();
      this.scenes.forEach((scene, i) => {
        const frame = frames[i];
        if (!frame || !this.renderer) return;
        scene.annotations.layOut(this.camera, (place) => this.pixel(place, frame.height));
        this.renderer.setViewport(frame.x, 0, frame.width, frame.height);
        this.renderer.setScissor(frame.x, 0, frame.width, frame.height);
        this.renderer.clear();
        this.renderer.render(scene.scene, this.camera);
        this.labels.place([...scene.annotations.labels, ...this.nameOf(scene, state.body)], this.camera, frame);
      });
    }
    this.labels.end();
    this.captions.forEach((caption, i) => this.caption(caption, state, state.runs[i], frames[i], i));
  }

  private nameOf(scene: RunScene, body: string | null): { at: [number, number, number]; text: string; kind: "name" }[] {
    const at = scene.run.bodies.findIndex((b) => b.name === body);
    const pose = scene.bodies.poses[at];
    return pose && body ? [{ at: [pose[0] ?? 0, pose[1] ?? 0, pose[2] ?? 0], text: body, kind: "name" }] : [];
  }

  private pixel(place: Vector3, height: number): number {
    return (2 * Math.tan((this.camera.fov * Math.PI) / 360) * place.distanceTo(this.camera.position)) / Math.max(height, 1);
  }

  /** Which run it is, if there are two, and what state the robot is in. */
  private caption(element: HTMLElement, state: State, run: Run | undefined, frame: Frame | undefined, i: number): void {
    element.hidden = !run;
    if (!run || !frame) return;
    element.style.left = `${frame.x + 10}px`;
    element.style.maxWidth = `${frame.width - 20}px`;
    const machines = run.machines.map((m) => stateAt(m, state.time)?.state).filter((s) => s !== undefined);
    const over = state.time > run.end ? [`ended at ${seconds(run.end, 2)}`] : [];
    const name = state.runs.length > 1 ? [`${"AB"[i] ?? ""}  ${run.label}`] : [];
    say(element, [...name, ...machines, ...over].join("   ·   "));
  }
}
