// The road from the driver's seat.

import * as THREE from "three";
import type { PageDrive } from "../built/seat";
import type { ViewSettings } from "./api";

/// What the view asks of a drive: places of the road on the map.
export interface Road {
  lanes: number; laneWidth: number; rightShoulder: number; leftShoulder: number; carLength: number; carWidth: number;
  places(road: Float64Array): Float64Array;
}

/// The road of a drive.
export function roadOf(drive: PageDrive): Road {
  const told = drive.road();
  const at = (i: number): number => told[i] as number;
  return {
    lanes: at(0), laneWidth: at(1), rightShoulder: at(3), leftShoulder: at(4), carLength: at(5), carWidth: at(6),
    places: (places) => drive.places(places),
  };
}

export interface Other { id: number; x: number; y: number; speed: number; braking: boolean; signal: number }

export interface Look {
  x: number; y: number; heading: number; wheel: number;
  others: Other[];
}

const PIECE_M = 100, BEHIND = -3, AHEAD = 9;
const SEAT_M = 0.36;
const SKY = 0xaec3d3;

/// Numbers that look random and are the same at the same place.
function scattered(seed: number): () => number {
  let state = (seed * 2654435761) >>> 0 || 1;
  return () => {
    state ^= state << 13; state >>>= 0; state ^= state >>> 17; state ^= state << 5; state >>>= 0;
    return state / 4294967296;
  };
}

/// Where the sun stands.
const SUN = new THREE.Vector3(-0.5, 1, 0.35).normalize();

/// Triangles with a colour each, gathered into one geometry. What stands still is lit once, when it is built: each picture is cheaper.
class Heap {
  private position: number[] = [];
  private color: number[] = [];

  triangle(a: THREE.Vector3, b: THREE.Vector3, c: THREE.Vector3, color: THREE.Color): void {
    const n = new THREE.Vector3().subVectors(b, a).cross(new THREE.Vector3().subVectors(c, a)).normalize();
    // Ground is seen from above, however it was put together.
    if (n.y < -0.9) n.negate();
    const light = 0.62 + 0.14 * n.y + 0.36 * Math.max(0, n.dot(SUN));
    for (const p of [a, b, c]) {
      this.position.push(p.x, p.y, p.z);
      this.color.push(color.r * light, color.g * light, color.b * light);
    }
  }

  quad(a: THREE.Vector3, b: THREE.Vector3, c: THREE.Vector3, d: THREE.Vector3, color: THREE.Color): void {
    this.triangle(a, b, c, color);
    this.triangle(a, c, d, color);
  }

  add(geometry: THREE.BufferGeometry, at: THREE.Matrix4, color: THREE.Color): void {
    const flat = geometry.index ? geometry.toNonIndexed() : geometry;
    const p = flat.getAttribute("position");
    const v = [0, 1, 2].map(() => new THREE.Vector3());
    for (let i = 0; i < p.count; i += 3) {
      v.forEach((w, k) => w.fromBufferAttribute(p, i + k).applyMatrix4(at));
      this.triangle(v[0] as THREE.Vector3, v[1] as THREE.Vector3, v[2] as THREE.Vector3, color);
    }
  }

  geometry(): THREE.BufferGeometry {
    const g = new THREE.BufferGeometry();
    g.setAttribute("position", new THREE.Float32BufferAttribute(this.position, 3));
    g.setAttribute("color", new THREE.Float32BufferAttribute(this.color, 3));
    return g;
  }
}

const colour = (hex: number): THREE.Color => new THREE.Color(hex);
const ASPHALT = colour(0x53555a), SHOULDER = colour(0x605f5c), WHITE = colour(0xe9e9e4), YELLOW = colour(0xd9b23a), STEEL = colour(0x9aa0a5), POST = colour(0x7b7f84);
const GRASS = [0x6d8a4b, 0x66834a, 0x748f52].map(colour), LEAVES = [0x3f6138, 0x4b6f3d, 0x35552f, 0x5c7a3f].map(colour), TRUNK = colour(0x5a4836);

/// Whether the browser draws without a graphics processor.
function drawnBySoftware(): boolean {
  const gl = document.createElement("canvas").getContext("webgl2");
  const info = gl?.getExtension("WEBGL_debug_renderer_info");
  const name = gl && info ? String(gl.getParameter(info.UNMASKED_RENDERER_WEBGL)) : "";
  gl?.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(name);
}

interface Piece { mesh: THREE.Mesh; x: number; y: number }

interface CarLook { group: THREE.Group; brake: THREE.MeshBasicMaterial; left: THREE.MeshBasicMaterial; right: THREE.MeshBasicMaterial }

export class View {
  private renderer: THREE.WebGLRenderer;
  private scene = new THREE.Scene();
  private camera = new THREE.PerspectiveCamera(44, 1, 0.15, 1400);
  private mirrorCamera = new THREE.PerspectiveCamera(22, 1, 0.4, 500);
  private hud = new THREE.Scene();
  private hudCamera = new THREE.OrthographicCamera(0, 1, 1, 0, -1, 1);
  private pieces = new Map<number, Piece>();
  private material = new THREE.MeshBasicMaterial({ vertexColors: true, side: THREE.DoubleSide });
  private cars = new Map<number, CarLook>();
  private inside = new THREE.Group();
  private wheel = new THREE.Group();
  private hills: THREE.Mesh;
  private mirrors: { target: THREE.WebGLRenderTarget; mesh: THREE.Mesh; side: number }[] = [];
  private frame = 0;
  private software: boolean;
  private scale = 1;
  /// Since when pictures are counted, and how many there were.
  private counted = { since: 0, pictures: 0 };
  /// How many frames a mirror waits for its next picture.
  private mirrorEvery = 3;

  constructor(private canvas: HTMLCanvasElement, private road: Road, private eyes: ViewSettings) {
    // Without a graphics processor smooth edges cost more than everything else.
    this.software = drawnBySoftware();
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: !this.software, powerPreference: "high-performance" });
    this.renderer.autoClear = false;
    this.scene.background = colour(SKY);
    this.scene.fog = new THREE.Fog(SKY, 250, 900);
    this.scene.add(new THREE.HemisphereLight(0xe8f0f8, 0x64704f, 1.9));
    const sun = new THREE.DirectionalLight(0xfff4df, 2.0);
    sun.position.copy(SUN);
    this.scene.add(sun);
    this.hills = this.horizon();
    this.scene.add(this.hills, this.inside);
    this.cockpit();
    for (const side of [0, 1, -1]) {
      const target = new THREE.WebGLRenderTarget(side === 0 ? 384 : 224, side === 0 ? 112 : 160);
      const plane = new THREE.PlaneGeometry(1, 1);
      // A mirror shows left where left is: the picture is turned about.
      const uv = plane.getAttribute("uv");
      for (let i = 0; i < uv.count; i++) uv.setX(i, 1 - uv.getX(i));
      const mesh = new THREE.Mesh(plane, new THREE.MeshBasicMaterial({ map: target.texture, toneMapped: false }));
      const frame = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), new THREE.MeshBasicMaterial({ color: 0x15171a }));
      frame.position.z = -0.1;
      frame.scale.set(1.035, 1.1, 1);
      mesh.add(frame);
      this.hud.add(mesh);
      this.mirrors.push({ target, mesh, side });
    }
    this.resize();
  }

  resize(): void {
    const [w, h] = [this.canvas.clientWidth || innerWidth, this.canvas.clientHeight || innerHeight];
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 1.5) * this.scale);
    this.renderer.setSize(w, h, false);
    const aspect = w / h, one = aspect / this.eyes.screens, middle = 0.5 * (aspect - one);
    this.camera.fov = this.eyes.field_deg;
    this.camera.aspect = one;
    this.camera.updateProjectionMatrix();
    Object.assign(this.hudCamera, { left: 0, right: aspect, top: 1, bottom: 0 });
    this.hudCamera.updateProjectionMatrix();
    for (const m of this.mirrors) {
      if (m.side === 0) { m.mesh.scale.set(0.4, 0.116, 1); m.mesh.position.set(middle + one * 0.64, 0.925, 0); }
      // On three screens the outer mirrors are on the outer screens, beside the middle one.
      else {
        const out = middle > 0 ? -0.125 : 0.125;
        m.mesh.scale.set(0.2, 0.143, 1);
        m.mesh.position.set(m.side > 0 ? middle + out : middle + one - out, 0.36, 0);
      }
    }
  }

  private horizon(): THREE.Mesh {
    const heap = new Heap();
    const random = scattered(77);
    const rise = (): number => 18 + 34 * random();
    const ring: number[] = Array.from({ length: 48 }, rise);
    const at = (i: number, up: number): THREE.Vector3 => {
      const angle = (i / ring.length) * 2 * Math.PI;
      return new THREE.Vector3(1150 * Math.cos(angle), up, 1150 * Math.sin(angle));
    };
    ring.forEach((up, i) => heap.quad(at(i, -30), at(i + 1, -30), at(i + 1, ring[(i + 1) % ring.length] as number), at(i, up), colour(0x8fa79f)));
    const material = new THREE.MeshBasicMaterial({ vertexColors: true, fog: false, side: THREE.DoubleSide });
    const mesh = new THREE.Mesh(heap.geometry(), material);
    mesh.renderOrder = -1;
    return mesh;
  }

  private cockpit(): void {
    const dark = new THREE.MeshLambertMaterial({ color: 0x1c1e22 });
    const paint = new THREE.MeshLambertMaterial({ color: 0x2d4a66 });
    const bonnet = new THREE.Mesh(new THREE.SphereGeometry(1, 24, 12, 0, 2 * Math.PI, 0, Math.PI / 2), paint);
    bonnet.scale.set(0.85, 0.16, 0.8);
    bonnet.position.set(1.5, 0.73, 0);
    const board = new THREE.Mesh(new THREE.BoxGeometry(0.6, 0.3, 2.6), new THREE.MeshBasicMaterial({ color: 0x1b1d21 }));
    board.position.set(0.8, 0.74, 0);
    const rim = new THREE.Mesh(new THREE.TorusGeometry(0.185, 0.016, 8, 32), dark);
    const spoke = new THREE.Mesh(new THREE.BoxGeometry(0.36, 0.035, 0.02), dark);
    this.wheel.add(rim, spoke);
    const column = new THREE.Group();
    column.position.set(0.52, 0.9, -SEAT_M);
    column.rotation.set(0, -Math.PI / 2, 0);
    const tilt = new THREE.Group();
    tilt.rotation.x = -0.4;
    tilt.add(this.wheel);
    column.add(tilt);
    const pillar = (z: number): THREE.Mesh => {
      const mesh = new THREE.Mesh(new THREE.BoxGeometry(0.05, 1.9, 0.045), dark);
      mesh.position.set(0.9, 1.2, z);
      mesh.rotation.z = 0.85;
      return mesh;
    };
    this.inside.add(bonnet, board, column, pillar(-0.92), pillar(0.92));
  }

  private build(index: number): Piece {
    const r = this.road, start = index * PIECE_M, steps = 10, by = PIECE_M / steps;
    const half = 0.5 * r.laneWidth, right = -half, left = (r.lanes - 0.5) * r.laneWidth;
    const heap = new Heap(), random = scattered(index + 1_000_003);
    const asked: number[] = [], found: { v: THREE.Vector3 }[] = [];
    const place = (x: number, y: number, up: number): { v: THREE.Vector3 } => {
      asked.push(start + x, y);
      const made = { v: new THREE.Vector3(0, up, 0) };
      found.push(made);
      return made;
    };
    const later: (() => void)[] = [];
    const ribbon = (y1: number, y2: number, up: number, color: THREE.Color, up2 = up): void => {
      for (let i = 0; i < steps; i++) {
        const [a, b, c, d] = [place(i * by, y1, up), place((i + 1) * by, y1, up), place((i + 1) * by, y2, up2), place(i * by, y2, up2)];
        later.push(() => heap.quad(a.v, b.v, c.v, d.v, color));
      }
    };
    const shape = (x: number, y: number, geometry: THREE.BufferGeometry, up: number, color: THREE.Color, size = 1): void => {
      const p = place(x, y, 0);
      later.push(() => heap.add(geometry, new THREE.Matrix4().makeScale(size, size, size).setPosition(p.v.x, up, p.v.z), color));
    };
    const [barrierRight, barrierLeft] = [right - r.rightShoulder, left + r.leftShoulder];
    ribbon(-220, barrierRight - 0.6, -0.12, GRASS[index & 1] as THREE.Color, -0.02);
    ribbon(barrierLeft + 0.6, 220, -0.02, GRASS[(index + 1) & 1] as THREE.Color, -0.12);
    ribbon(barrierRight - 0.6, right, 0, SHOULDER);
    ribbon(right, left, 0, ASPHALT);
    ribbon(left, barrierLeft + 0.6, 0, SHOULDER);
    ribbon(right + 0.05, right + 0.2, 0.012, WHITE);
    ribbon(left - 0.2, left - 0.05, 0.012, YELLOW);
    for (const [y, out] of [[barrierRight, -1], [barrierLeft, 1]] as const) {
      if (out < 0) { ribbon(y, y, 0.5, STEEL, 0.78); } else { ribbon(y, y, 0.78, STEEL, 0.5); }
      ribbon(out < 0 ? y - 0.08 : y, out < 0 ? y : y + 0.08, 0.78, STEEL);
      const post = new THREE.BoxGeometry(0.1, 0.74, 0.1);
      for (let x = 0; x < PIECE_M; x += 4) shape(x, y + out * 0.1, post, 0.37, POST);
    }
    for (let lane = 0; lane + 1 < r.lanes; lane++) {
      const y = (lane + 0.5) * r.laneWidth;
      // Three metres of mark, nine of gap.
      for (let x = 0; x < PIECE_M; x += 12.5) {
        const [a, b, c, d] = [place(x, y - 0.07, 0.012), place(x + 3.1, y - 0.07, 0.012), place(x + 3.1, y + 0.07, 0.012), place(x, y + 0.07, 0.012)];
        later.push(() => heap.quad(a.v, b.v, c.v, d.v, WHITE));
      }
    }
    const trunk = new THREE.CylinderGeometry(0.18, 0.26, 2.4, 5, 1, true);
    const crown = new THREE.IcosahedronGeometry(2.1, 0), fir = new THREE.ConeGeometry(1.9, 6.2, 6, 1, true);
    for (let i = 0; i < 16; i++) {
      const onRight = i % 2 === 0;
      const off = 5 + 60 * random() ** 1.7, x = PIECE_M * random(), size = 0.7 + 0.8 * random();
      const y = onRight ? barrierRight - off : barrierLeft + off;
      const green = LEAVES[Math.floor(LEAVES.length * random())] as THREE.Color;
      shape(x, y, trunk, 1.2 * size, TRUNK, size);
      if (random() < 0.45) shape(x, y, fir, 4.6 * size, green, size);
      else { shape(x, y, crown, 3.6 * size, green, size); shape(x + 0.9, y + 0.7, crown, 4.7 * size, green, 0.7 * size); }
    }
    const reflector = new THREE.BoxGeometry(0.08, 0.9, 0.08);
    for (const x of [0, 50]) shape(x, barrierRight - 0.45, reflector, 0.95, WHITE);
    asked.push(start, 0);
    const map = this.road.places(Float64Array.from(asked));
    const o = map.length - 3, [ox, oy] = [map[o] as number, map[o + 1] as number];
    found.forEach((p, i) => { p.v.x = (map[3 * i] as number) - ox; p.v.z = -((map[3 * i + 1] as number) - oy); });
    for (const draw of later) draw();
    const mesh = new THREE.Mesh(heap.geometry(), this.material);
    this.scene.add(mesh);
    return { mesh, x: ox, y: oy };
  }

  private car(id: number): CarLook {
    const random = scattered(id * 7 + 3);
    random();
    const paints = [0xb8bcc0, 0x2f3238, 0x8b1e1e, 0xe8e8e4, 0x2c4b78, 0x5d6b5a, 0x757a80];
    const paint = new THREE.MeshLambertMaterial({ color: paints[Math.floor(paints.length * random())] as number });
    const glass = new THREE.MeshLambertMaterial({ color: 0x20262c });
    const black = new THREE.MeshLambertMaterial({ color: 0x17181a });
    const [l, w] = [this.road.carLength, this.road.carWidth];
    const box = (x: number, y: number, z: number, at: [number, number, number], m: THREE.Material): THREE.Mesh => {
      const mesh = new THREE.Mesh(new THREE.BoxGeometry(x, y, z), m);
      mesh.position.set(...at);
      return mesh;
    };
    const group = new THREE.Group();
    group.add(box(l, 0.62, w, [0, 0.62, 0], paint));
    const cabin = new THREE.Mesh(new THREE.CylinderGeometry(0.92, 1.32, 0.56, 4, 1), glass);
    cabin.rotation.y = Math.PI / 4;
    const upper = new THREE.Group();
    upper.add(cabin);
    upper.scale.set(1.25, 1, 0.93);
    upper.position.set(-0.25, 1.2, 0);
    group.add(upper, box(2.0, 0.05, w * 0.72, [-0.25, 1.49, 0], paint));
    for (const x of [-0.31 * l, 0.31 * l]) for (const z of [-1, 1]) {
      const tyre = new THREE.Mesh(new THREE.CylinderGeometry(0.33, 0.33, 0.22, 14), black);
      tyre.rotation.x = Math.PI / 2;
      tyre.position.set(x, 0.33, z * (w / 2 - 0.1));
      group.add(tyre);
    }
    const lamp = (): THREE.MeshBasicMaterial => new THREE.MeshBasicMaterial({ color: 0x5a1010 });
    const [brake, left, right] = [lamp(), lamp(), lamp()];
    const rear = -l / 2 - 0.01;
    group.add(box(0.04, 0.14, 0.4, [rear, 0.78, -w / 2 + 0.32], brake), box(0.04, 0.14, 0.4, [rear, 0.78, w / 2 - 0.32], brake));
    group.add(box(0.04, 0.05, 0.5, [-1.3, 1.4, 0], brake), box(0.03, 0.14, 0.5, [rear, 0.62, 0], new THREE.MeshBasicMaterial({ color: 0xd8d8d0 })));
    group.add(box(0.05, 0.14, 0.12, [rear, 0.78, -w / 2 + 0.06], left), box(0.05, 0.14, 0.12, [rear, 0.78, w / 2 - 0.06], right));
    const head = new THREE.MeshBasicMaterial({ color: 0xfff6da });
    group.add(box(0.04, 0.13, 0.36, [l / 2 + 0.01, 0.7, -w / 2 + 0.3], head), box(0.04, 0.13, 0.36, [l / 2 + 0.01, 0.7, w / 2 - 0.3], head));
    this.scene.add(group);
    return { group, brake, left, right };
  }

  /// Draws one picture.
  draw(look: Look, time: number): void {
    const first = Math.floor(look.x / PIECE_M) + BEHIND, last = first - BEHIND + AHEAD;
    for (const [index, piece] of this.pieces) if (index < first || index > last) {
      this.scene.remove(piece.mesh);
      piece.mesh.geometry.dispose();
      this.pieces.delete(index);
    }
    // One new piece a picture: building them all at once would be seen as a stutter.
    for (let index = first, built = this.pieces.size === 0 ? -99 : 0; index <= last && built < 1; index++) {
      if (!this.pieces.has(index)) { this.pieces.set(index, this.build(index)); built++; }
    }
    const asked = Float64Array.from([look.x, look.y, ...look.others.flatMap((o) => [o.x, o.y])]);
    const map = this.road.places(asked);
    const [ex, ey, eh] = [map[0] as number, map[1] as number, (map[2] as number) + look.heading];
    for (const piece of this.pieces.values()) piece.mesh.position.set(piece.x - ex, 0, -(piece.y - ey));
    const there = new Set<number>();
    const blink = Math.floor(time / 380) % 2 === 0;
    look.others.forEach((other, i) => {
      there.add(other.id);
      let car = this.cars.get(other.id);
      if (!car) { car = this.car(other.id); this.cars.set(other.id, car); }
      const k = 3 * (i + 1);
      car.group.position.set((map[k] as number) - ex, 0, -((map[k + 1] as number) - ey));
      car.group.rotation.y = map[k + 2] as number;
      car.brake.color.setHex(other.braking ? 0xff2a1c : 0x6a1414);
      car.left.color.setHex(other.signal > 0 && blink ? 0xffa31a : 0x6a3a10);
      car.right.color.setHex(other.signal < 0 && blink ? 0xffa31a : 0x6a3a10);
    });
    for (const [id, car] of this.cars) if (!there.has(id)) { this.scene.remove(car.group); this.cars.delete(id); }
    this.inside.rotation.y = eh;
    this.wheel.rotation.z = 15 * look.wheel;
    const ahead = new THREE.Vector3(Math.cos(eh), 0, -Math.sin(eh)), toLeft = new THREE.Vector3(-Math.sin(eh), 0, -Math.cos(eh));
    const eye = toLeft.clone().multiplyScalar(SEAT_M).setY(this.eyes.eye_m);
    this.camera.position.copy(eye);
    this.mirror(ahead, toLeft);
    this.renderer.setRenderTarget(null);
    this.renderer.clear();
    this.screens(eye, eh);
    this.renderer.clearDepth();
    this.renderer.render(this.hud, this.hudCamera);
    this.frame++;
    this.pace(time);
  }

  /// One picture, or three side by side, the outer ones turned outwards.
  private screens(eye: THREE.Vector3, heading: number): void {
    const size = this.renderer.getSize(new THREE.Vector2());
    const n = this.eyes.screens, width = size.x / n, outwards = this.eyes.side_deg * Math.PI / 180;
    for (let i = 0; i < n; i++) {
      const way = heading + ((n - 1) / 2 - i) * outwards;
      this.camera.lookAt(eye.x + 60 * Math.cos(way), this.eyes.eye_m - 3.2, eye.z - 60 * Math.sin(way));
      this.renderer.setViewport(i * width, 0, width, size.y);
      this.renderer.setScissor(i * width, 0, width, size.y);
      this.renderer.setScissorTest(n > 1);
      this.renderer.render(this.scene, this.camera);
    }
    this.renderer.setViewport(0, 0, size.x, size.y);
    this.renderer.setScissorTest(false);
  }

  private mirror(ahead: THREE.Vector3, toLeft: THREE.Vector3): void {
    const due = this.frame % this.mirrorEvery;
    const m = this.mirrors[due];
    if (!m) return;
    this.inside.visible = false;
    const at = toLeft.clone().multiplyScalar(m.side === 0 ? 0 : m.side * 0.95).addScaledVector(ahead, m.side === 0 ? 0.3 : 0.7).setY(m.side === 0 ? 1.3 : 1.0);
    this.mirrorCamera.fov = m.side === 0 ? 14 : 22;
    this.mirrorCamera.aspect = m.target.width / m.target.height;
    this.mirrorCamera.updateProjectionMatrix();
    this.mirrorCamera.position.copy(at);
    const out = m.side === 0 ? 0 : m.side * 0.24;
    this.mirrorCamera.lookAt(at.clone().addScaledVector(ahead, -60).addScaledVector(toLeft, 60 * out).setY(0.4));
    this.renderer.setRenderTarget(m.target);
    this.renderer.clear();
    this.renderer.render(this.scene, this.mirrorCamera);
    this.inside.visible = true;
  }

  /// A plainer picture below 50 a second: first fewer pixels, then mirrors less often.
  private pace(time: number): void {
    const { since, pictures } = this.counted;
    if (since > 0 && time - since < 1000) { this.counted.pictures++; return; }
    this.counted = { since: time, pictures: 0 };
    // The first second builds the road.
    if (since === 0 || this.frame < 20 || (time - since) / (pictures + 1) <= 20) return;
    if (this.scale > 0.5) { this.scale = Math.max(0.5, this.scale - 0.25); this.resize(); }
    else if (this.mirrorEvery < 9) this.mirrorEvery += 3;
  }

  /// What the picture leaves out, for the record.
  get plainness(): string { return `picture: ${this.software ? "drawn by software, " : ""}scale ${this.scale}, each mirror every ${this.mirrorEvery} pictures`; }

  dispose(): void {
    for (const piece of this.pieces.values()) piece.mesh.geometry.dispose();
    for (const m of this.mirrors) m.target.dispose();
    this.renderer.dispose();
  }
}
