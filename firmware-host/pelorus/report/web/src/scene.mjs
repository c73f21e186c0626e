// The reconstructed scene as three.js objects, and their places in each frame.

import * as THREE from 'three';
import {Line2} from 'three/addons/lines/Line2.js';
import {LineGeometry} from 'three/addons/lines/LineGeometry.js';
import {LineMaterial} from 'three/addons/lines/LineMaterial.js';
import {triples} from './geometry.mjs';

const VEHICLE_COLOR = '#ffffff';

function pointCloud(coordinates, size, material) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(coordinates, 3));
  return new THREE.Points(geometry, new THREE.PointsMaterial({size, sizeAttenuation: false, ...material}));
}

// The brightness of the pictures, on the tone of the static scene.
function seabed(scene) {
  const cloud = pointCloud(scene.points, 3, {vertexColors: true});
  const tone = new THREE.Color(scene.color);
  const colors = scene.gray.flatMap((gray) => {
    const level = 0.45 + (0.9 * gray) / 255;
    return [tone.r * level, tone.g * level, tone.b * level];
  });
  cloud.geometry.setAttribute('color', new THREE.Float32BufferAttribute(colors, 3));
  return cloud;
}

// A path that grows with the frames: segments up to the frame shown are drawn strong, all of them faintly.
class Way {
  constructor(points, color, lines) {
    this.counts = [];
    const positions = [];
    for (const p of points) {
      if (p) positions.push(...p);
      this.counts.push(positions.length / 3);
    }
    this.group = new THREE.Group();
    if (positions.length < 6) return;
    const geometry = new LineGeometry().setPositions(positions);
    this.line = new Line2(geometry, lines.material(color, 2.5));
    const faint = new THREE.BufferGeometry();
    faint.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
    this.group.add(this.line, new THREE.Line(faint, new THREE.LineBasicMaterial({color, transparent: true, opacity: 0.3})));
    // Bounds of all segments hold for any part of them.
    this.line.frustumCulled = false;
  }

  show(frame) {
    if (this.line) this.line.geometry.instanceCount = Math.max(0, this.counts[frame] - 1);
  }
}

// Lines wider than a pixel need to know the size of the canvas.
class Lines {
  constructor() {
    this.materials = [];
  }

  material(color, linewidth) {
    const material = new LineMaterial({color, linewidth});
    this.materials.push(material);
    return material;
  }

  resize(width, height) {
    for (const material of this.materials) material.resolution.set(width, height);
  }
}

function label(text, color) {
  const canvas = document.createElement('canvas');
  const pen = canvas.getContext('2d');
  const font = 'bold 44px system-ui, sans-serif';
  pen.font = font;
  canvas.width = Math.ceil(pen.measureText(text).width) + 16;
  canvas.height = 64;
  pen.font = font; // a new size forgets it
  pen.textAlign = 'center';
  pen.textBaseline = 'middle';
  // White on the body's color: dark colors would not be read on dark water.
  pen.lineJoin = 'round';
  pen.lineWidth = 12;
  pen.strokeStyle = color;
  pen.strokeText(text, canvas.width / 2, 32);
  pen.fillStyle = '#ffffff';
  pen.fillText(text, canvas.width / 2, 32);
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({map, sizeAttenuation: false, depthTest: false}));
  sprite.scale.set((0.045 * canvas.width) / 64, 0.045, 1);
  sprite.center.set(0.5, -0.6);
  return sprite;
}

// x right, y down, z forward: the pyramid of the left camera's view, and its two axes.
function vehicle(size) {
  const [w, h, d] = [0.5 * size, 0.375 * size, 0.8 * size];
  const corners = [[-w, -h, d], [w, -h, d], [w, h, d], [-w, h, d]];
  const edges = [];
  corners.forEach((corner, i) => edges.push(0, 0, 0, ...corner, ...corner, ...corners[(i + 1) % 4]));
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(edges, 3));
  const group = new THREE.Group();
  const body = new THREE.Mesh(new THREE.SphereGeometry(0.1 * size, 16, 12), new THREE.MeshBasicMaterial({color: VEHICLE_COLOR}));
  group.add(new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({color: VEHICLE_COLOR})), body);
  return group;
}

class MovingObject {
  constructor(object, count, lines) {
    this.object = object;
    this.row = new Array(count).fill(-1);
    object.frame.forEach((frame, i) => (this.row[frame] = i));
    this.group = new THREE.Group();
    this.cloud = pointCloud(object.points, 4, {color: object.color});
    this.material = lines.material(object.color, 2.5);
    this.outline = new Line2(new LineGeometry(), this.material);
    this.outline.frustumCulled = false;
    this.face = new THREE.Mesh(new THREE.BufferGeometry(),
      new THREE.MeshBasicMaterial({color: object.color, transparent: true, opacity: 0.22, side: THREE.DoubleSide, depthWrite: false}));
    this.face.frustumCulled = false;
    this.group.add(this.cloud, this.outline, this.face, label(object.name, object.color));
    const points = new Array(count).fill(null);
    triples(object.pose, 7).forEach((p, i) => (points[object.frame[i]] = p));
    this.way = new Way(points, object.color, lines);
  }

  show(frame, layers) {
    const row = this.row[frame];
    this.group.visible = row >= 0;
    this.way.show(frame);
    this.cloud.visible = layers.objects;
    if (row < 0) return;
    place(this.group, this.object.pose, row);
    // A coasting object is extrapolated: fainter, as its outline in the pictures is dashed.
    const coasting = this.object.coasting[row] === 1;
    this.cloud.material.opacity = coasting ? 0.4 : 1;
    this.cloud.material.transparent = coasting;
    const corners = this.object.outline[row];
    const has = layers.outlines && corners.length >= 9;
    this.outline.visible = this.face.visible = has;
    if (!has) return;
    this.outline.geometry.dispose();
    this.outline.geometry = new LineGeometry().setPositions([...corners, ...corners.slice(0, 3)]);
    const fan = [];
    for (let i = 1; i + 1 < corners.length / 3; ++i) fan.push(0, i, i + 1);
    this.face.geometry.dispose();
    this.face.geometry = new THREE.BufferGeometry();
    this.face.geometry.setAttribute('position', new THREE.Float32BufferAttribute(corners, 3));
    this.face.geometry.setIndex(fan);
  }
}

// Pose number `row`: x y z, quaternion w x y z.
function place(group, poses, row) {
  const [x, y, z, qw, qx, qy, qz] = poses.slice(7 * row, 7 * row + 7);
  group.position.set(x, y, z);
  group.quaternion.set(qx, qy, qz, qw);
}

function dashed(points, color) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(points.filter(Boolean).flat(), 3));
  const line = new THREE.Line(geometry, new THREE.LineDashedMaterial({color, dashSize: 0.06, gapSize: 0.05}));
  line.computeLineDistances();
  return line;
}

export class ReplayScene {
  constructor(run) {
    this.run = run;
    this.layers = {seabed: true, objects: true, outlines: true, paths: true, truth: true};
    this.lines = new Lines();
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color('#0d1720');
    // Everything is given in the world; the axes of the view put its up above.
    this.world = new THREE.Group();
    const R = run.scene.R_view_world;
    this.world.matrixAutoUpdate = false;
    this.world.matrix.set(R[0], R[1], R[2], 0, R[3], R[4], R[5], 0, R[6], R[7], R[8], 0, 0, 0, 0, 1);
    this.scene.add(this.world);
    const count = run.frames.time_s.length;
    this.seabed = seabed(run.scene);
    this.objects = run.objects.map((object) => new MovingObject(object, count, this.lines));
    this.vehicleWay = new Way(triples(run.frames.camera, 7), VEHICLE_COLOR, this.lines);
    this.truth = new THREE.Group();
    if (run.frames.truth) this.truth.add(dashed(triples(run.frames.truth), '#8fb7d8'));
    for (const body of run.true_bodies) this.truth.add(dashed(triples(body.p), body.color));
    this.bounds = this.#bounds();
    this.vehicle = vehicle(Math.min(0.4, Math.max(0.02, 0.07 * this.bounds.radius)));
    this.ways = new THREE.Group();
    this.ways.add(this.vehicleWay.group, ...this.objects.map((object) => object.way.group));
    this.world.add(this.seabed, this.vehicle, this.ways, this.truth, ...this.objects.map((object) => object.group));
    this.world.updateMatrixWorld(true);
  }

  // In the axes of the view.
  #bounds() {
    const box = new THREE.Box3();
    const add = (p) => p && box.expandByPoint(new THREE.Vector3(...p).applyMatrix4(this.world.matrix));
    triples(this.run.frames.camera, 7).forEach(add);
    for (const object of this.run.objects) triples(object.pose, 7).forEach(add);
    triples(this.run.scene.points).forEach((p, i) => i % 5 === 0 && add(p));
    if (box.isEmpty()) box.expandByPoint(new THREE.Vector3());
    const sphere = box.getBoundingSphere(new THREE.Sphere());
    sphere.radius = Math.max(sphere.radius, 0.1);
    return sphere;
  }

  // The vehicle's place in the axes of the view: as it stands in the scene that is drawn.
  vehiclePosition() {
    return this.vehicle.getWorldPosition(new THREE.Vector3());
  }

  // Of each outline on the screen, the middle of its corners as they are drawn, in the axes of the view.
  shownOutlines() {
    const middles = {};
    for (const {object, group, outline} of this.objects) {
      if (!group.visible || !outline.visible) continue;
      const corners = outline.geometry.getAttribute('instanceStart');
      const middle = new THREE.Vector3();
      for (let i = 0; i < corners.count; ++i) middle.add(new THREE.Vector3().fromBufferAttribute(corners, i));
      middles[object.id] = group.localToWorld(middle.divideScalar(corners.count)).toArray();
    }
    return middles;
  }

  show(frame) {
    this.vehicle.visible = this.run.frames.camera[7 * frame] !== null;
    if (this.vehicle.visible) place(this.vehicle, this.run.frames.camera, frame);
    this.vehicleWay.show(frame);
    for (const object of this.objects) object.show(frame, this.layers);
    this.seabed.visible = this.layers.seabed;
    this.ways.visible = this.layers.paths;
    this.truth.visible = this.layers.truth;
    this.world.updateMatrixWorld(true);
  }
}
