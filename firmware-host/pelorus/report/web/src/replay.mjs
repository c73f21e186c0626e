// The replay in 3D: canvas, camera, controls. Draws only when something changed.

import * as THREE from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {element, figure} from './format.mjs';
import {ReplayScene} from './scene.mjs';

const LAYERS = {seabed: 'points of the static scene', objects: 'points of objects', outlines: 'outlines', paths: 'trajectories', truth: 'truth (dashed)'};
// From where to look, in the axes of the view (x along the track, z up).
const DIRECTIONS = {scene: [-0.6, -0.9, 0.6], top: [0, -1e-3, 1], side: [0, -1, 0]};

const byId = (id) => document.getElementById(id);

class Viewer {
  constructor(run, playback, stage) {
    this.run = run;
    this.playback = playback;
    this.renderer = new THREE.WebGLRenderer({antialias: true});
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio));
    this.content = new ReplayScene(run);
    this.camera = new THREE.PerspectiveCamera(45, 1, 0.01, 1000);
    this.camera.up.set(0, 0, 1);
    const canvas = this.renderer.domElement;
    canvas.tabIndex = 0;
    canvas.setAttribute('aria-label', 'Scene in 3D: vehicle, objects and points of the frame shown');
    stage.append(canvas);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener('change', () => this.request());
    this.follows = false;
    this.aim('scene');
    this.last = this.content.vehiclePosition();
    new ResizeObserver(() => this.resize(stage)).observe(stage);
    this.resize(stage);
    this.update();
  }

  resize(stage) {
    const {clientWidth: width, clientHeight: height} = stage;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.content.lines.resize(width, height);
    this.request();
  }

  aim(view) {
    this.view = view;
    this.controls.enabled = view !== 'camera';
    const {center, radius} = this.content.bounds;
    this.camera.near = radius / 500;
    this.camera.far = radius * 50;
    this.camera.fov = view === 'camera' ? 55 : 45;
    this.camera.updateProjectionMatrix();
    if (view !== 'camera') {
      const distance = view === 'scene' ? 1.4 * radius : 1.3 * radius;
      const direction = new THREE.Vector3(...DIRECTIONS[view]).normalize();
      this.controls.target.copy(center);
      this.camera.position.copy(center).addScaledVector(direction, distance);
      this.controls.update();
    }
    this.update();
  }

  // Moves eye and target with the vehicle, so that the user's own angle and distance stay.
  follow(on) {
    this.follows = on;
    if (on) {
      const shift = this.content.vehiclePosition().sub(this.controls.target);
      this.camera.position.add(shift);
      this.controls.target.add(shift);
      this.controls.update();
    }
    this.request();
  }

  update() {
    this.content.show(this.playback.frame);
    const vehicle = this.content.vehiclePosition();
    if (this.follows && this.last) {
      const shift = vehicle.clone().sub(this.last);
      this.camera.position.add(shift);
      this.controls.target.add(shift);
      this.controls.update();
    }
    this.last = vehicle;
    if (this.view === 'camera') this.lookThroughVehicle();
    this.request();
  }

  // In the axes of the view.
  shown() {
    return {frame: this.playback.frame, vehicle: this.content.vehiclePosition().toArray(), target: this.controls.target.toArray(),
      eye: this.camera.position.toArray(), outlines: this.content.shownOutlines()};
  }

  lookThroughVehicle() {
    const {vehicle} = this.content;
    vehicle.visible = false;
    vehicle.getWorldPosition(this.camera.position);
    // Cameras of three.js look along -z with y up, ours along z with y down.
    vehicle.getWorldQuaternion(this.camera.quaternion).multiply(new THREE.Quaternion(1, 0, 0, 0));
  }

  request() {
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame(() => {
      this.requested = false;
      this.render();
    });
  }

  render() {
    this.renderer.render(this.content.scene, this.camera);
  }
}

// Paper shows the frame that was chosen; where none was, the last one, which has all of the trajectories. A canvas of
// WebGL is printed as it was shown last: a copy of what is drawn now stands for it.
function connectPrint(playback, viewer, stage) {
  const drawn = viewer.renderer.domElement;
  const copy = element('canvas', {className: 'printed'});
  stage.append(copy);
  let untouched = false;
  window.addEventListener('beforeprint', () => {
    untouched = playback.frame === 0;
    if (untouched) playback.seek(playback.last);
    viewer.render();
    copy.width = drawn.width;
    copy.height = drawn.height;
    copy.getContext('2d').drawImage(drawn, 0, 0);
  });
  window.addEventListener('afterprint', () => untouched && playback.seek(0));
}

function connectPlayback(run, playback) {
  const play = byId('play');
  const position = byId('position');
  position.max = String(playback.last);
  const showClock = () => {
    position.value = String(playback.frame);
    byId('clock').textContent = `${figure(run.frames.time_s[playback.frame], 4)} s, frame ${run.frames.seq[playback.frame]}, ` +
      run.state_names[run.frames.state[playback.frame]];
  };
  play.addEventListener('click', () => playback.toggle());
  position.addEventListener('input', () => playback.seek(Number(position.value)));
  byId('speed').addEventListener('change', (event) => (playback.speed = Number(event.target.value)));
  document.addEventListener('keydown', (event) => {
    if (event.key !== ' ' || ['INPUT', 'SELECT', 'BUTTON', 'SUMMARY'].includes(event.target.tagName)) return;
    event.preventDefault();
    playback.toggle();
  });
  playback.addEventListener('frame', showClock);
  playback.addEventListener('state', () => {
    play.textContent = playback.playing ? 'Pause' : 'Play';
    play.setAttribute('aria-pressed', String(playback.playing));
  });
  showClock();
}

function connectView(run, viewer) {
  byId('view').addEventListener('change', (event) => {
    viewer.aim(event.target.value);
    viewer.follow(byId('follow').checked && event.target.value !== 'camera');
  });
  byId('follow').addEventListener('change', (event) => viewer.follow(event.target.checked));
  for (const [name, text] of Object.entries(LAYERS)) {
    if (name === 'truth' && !run.frames.truth) continue;
    const box = element('input', {type: 'checkbox', checked: true});
    box.addEventListener('change', () => {
      viewer.content.layers[name] = box.checked;
      viewer.update();
    });
    byId('layers').append(element('label', {}, box, ` ${text}`));
  }
}

// WebGL may be switched off or missing: the rest of the page does without.
function hasWebGl() {
  return Boolean(document.createElement('canvas').getContext('webgl2'));
}

export function showReplay(run, playback) {
  connectPlayback(run, playback);
  const stage = byId('stage');
  if (!hasWebGl()) {
    stage.append(element('p', {textContent: 'This browser shows no 3D here (WebGL 2 is off or missing). The trajectories below move with the play button.'}));
    return;
  }
  const viewer = new Viewer(run, playback, stage);
  playback.addEventListener('frame', () => viewer.update());
  connectView(run, viewer);
  connectPrint(playback, viewer, stage);
  stage.shown = () => viewer.shown(); // for tests and for scripts, at the time they ask
}
