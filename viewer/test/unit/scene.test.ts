// What the scene is worked out from: nearest points, and many bodies as one thing to draw.

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { LineSegments, Matrix4, Mesh, type ShaderMaterial } from "three";
import type { ViewBody, ViewDocument, ViewShape } from "../../src/data/document.js";
import { runOf } from "../../src/data/run.js";
import { Bodies } from "../../src/scene/bodies.js";
import { nearestPoints } from "../../src/scene/nearest.js";
import type { Palette } from "../../src/ui/theme.js";
import { homecareSample } from "../samples/homecare.js";

const near = (a: readonly number[] | undefined, b: readonly number[], by = 1e-6) => assert.ok(a && a.every((x, i) => Math.abs(x - (b[i] ?? 0)) <= by), `${a?.join()} is not ${b.join()}`);
const body = (...shapes: ViewShape[]): ViewBody => ({ name: "a", kind: "thing", pose: [0, 0, 0, 0, 0, 0, 1], shapes });
const points = (a: ViewBody, at: number[], b: ViewBody, there: number[]) => nearestPoints([a, b], { cube: { points: [-1000, -1000, -1000, 1000, -1000, -1000, -1000, 1000, -1000, -1000, -1000, 1000, 1000, 1000, 1000], triangles: [] } }, [at, there], [0, 1]);
const apart = (pair: ReturnType<typeof points>) => (pair ? Math.hypot(...pair.a.map((x, i) => x - (pair.b[i] ?? 0))) : Number.NaN);

test("the nearest points of two bodies lie on their surfaces", () => {
  const [ball, box] = [body({ kind: "sphere", radius: 0.1 }), body({ kind: "box", size: [1, 2, 3] })];
  const beside = points(ball, [2, 0.5, 1, 0, 0, 0, 1], box, [0, 0, 0, 0, 0, 0, 1]);
  near(beside?.a, [1.9, 0.5, 1]);
  near(beside?.b, [0.5, 0.5, 1]);
  // A quarter of a turn about z: the long edge lies along x.
  near(points(ball, [2, 0, 0, 0, 0, 0, 1], box, [0, 0, 0, 0, 0, Math.SQRT1_2, Math.SQRT1_2])?.b, [1, 0, 0], 1e-5);
  const corner = points(box, [0, 0, 0, 0, 0, 0, 1], box, [2, 3, 4, 0, 0, 0, 1]);
  near(corner?.a, [0.5, 1, 1.5]);
  near(corner?.b, [1.5, 2, 2.5]);
});

test("round and tapering bodies, too", () => {
  const [can, pill] = [body({ kind: "cylinder", radius: 0.3, length: 1 }), body({ kind: "capsule", radius: 0.2, length: 1 })];
  near([apart(points(can, [0, 0, 0, 0, 0, 0, 1], pill, [1, 0, 0.2, 0, 0, 0, 1]))], [0.5], 1e-4);
  near([apart(points(can, [0, 0, 0, 0, 0, 0, 1], pill, [0, 0, 2, 0, 0, 0, 1]))], [0.8], 1e-4);
  near([apart(points(pill, [0, 0, 0, 0, 0, 0, 1], pill, [3, 4, 0, 0, 0, 0, 1]))], [4.6], 1e-6);
  const mesh = body({ kind: "mesh", mesh: "cube" });
  near([apart(points(mesh, [0, 0, 0, 0, 0, 0, 1], body({ kind: "sphere", radius: 0.05 }), [0.4, 0.1, 0.1, 0, 0, 0, 1]))], [0.25], 1e-4);
  // Of several shapes the nearest counts; a mesh that is gone has none.
  const two = body({ kind: "sphere", radius: 0.1, pose: [5, 0, 0, 0, 0, 0, 1] }, { kind: "sphere", radius: 0.1 });
  near([apart(points(two, [0, 0, 0, 0, 0, 0, 1], pill, [7, 0, 0, 0, 0, 0, 1]))], [1.7], 1e-6);
  assert.equal(points(body({ kind: "mesh", mesh: "gone" }), [0, 0, 0, 0, 0, 0, 1], pill, [7, 0, 0, 0, 0, 0, 1]), null);
});

const palette: Palette = new Proxy({ dark: false }, { get: (of, key) => (key === "dark" ? of.dark : "#808080") }) as unknown as Palette;
const sample = () => runOf("a", "a", homecareSample(), {});
const shown = (bodies: Bodies) => {
  const objects: (Mesh | LineSegments)[] = [];
  bodies.group.traverseVisible((object) => (object instanceof Mesh || object instanceof LineSegments) && objects.push(object));
  return { objects, corners: objects.reduce((sum, object) => sum + (object.geometry.index?.count ?? object.geometry.getAttribute("position").count), 0) };
};

test("where triangles cost time, bodies are few things with few triangles, in the same places", () => {
  const bodies = new Bodies(sample(), palette, true);
  bodies.update(10, null, true);
  const fine = shown(bodies);
  bodies.roughen(true);
  const rough = shown(bodies);
  assert.ok(rough.objects.length * 4 < fine.objects.length, `${rough.objects.length} of ${fine.objects.length}`);
  assert.ok(rough.corners * 2 < fine.corners, `${rough.corners} of ${fine.corners}`);
  bodies.update(62, null, false);
  // Each body's corners are where those of the body by itself would be.
  const batches = rough.objects.filter((object) => object instanceof Mesh && object.geometry.getAttribute("tint"));
  const poses = batches.flatMap((object) => {
    const all = (object.material as ShaderMaterial).uniforms["poses"]?.value as Float32Array;
    return Array.from({ length: all.length / 16 }, (_, i) => new Matrix4().fromArray(all, i * 16).elements.join());
  });
  bodies.roughen(false);
  const own = shown(bodies).objects.filter((object) => object instanceof Mesh && object.userData["body"] !== undefined);
  assert.ok(own.length > 20);
  const known = new Set(own.map((object) => new Matrix4().fromArray(Float32Array.from(object.matrix.elements)).elements.join()));
  assert.ok(poses.length > 20 && poses.every((pose) => known.has(pose)));
  assert.equal(shown(bodies).objects.length, fine.objects.length);
  bodies.dispose();
});

test("distances that nobody measured point by point are drawn all the same", () => {
  const every = JSON.parse(readFileSync("test/every-field.json", "utf8")) as ViewDocument;
  const { bodies, meshes, notes } = runOf("a", "a", every, {});
  const pair = nearestPoints(bodies, meshes, bodies.map((b) => b.pose), [1, 2]);
  assert.ok(pair && pair.a[0] > 0.04 && pair.b[0] < 0.97);
  assert.doesNotMatch(notes.join(), /origins/);
});
