// Header, key figures and the tables with the exact figures of the evaluation.

import {CM_PER_M, DEG_PER_RAD, element, figure, isKnown, percent, table} from './format.mjs';
import {bodyName, objectName} from './names.mjs';

const byId = (id) => document.getElementById(id);

function fact(name, value, detail = '') {
  const dd = element('dd', {textContent: value});
  if (detail) dd.append(element('small', {textContent: detail}));
  byId('facts').append(element('div', {}, element('dt', {textContent: name}), dd));
}

// Centimeters for what is small, meters for roads.
export function lengthUnit(values) {
  const largest = Math.max(0, ...values.filter((value) => value !== null));
  return largest > 1 ? {name: 'm', factor: 1} : {name: 'cm', factor: CM_PER_M};
}

const inCm = (value) => (!isKnown(value) ? '-' : `${figure(value * CM_PER_M)} cm`);
const inDeg = (value) => (!isKnown(value) ? '-' : `${figure(value * DEG_PER_RAD)} deg`);

function showSummary(run) {
  const {evaluation} = run;
  const seconds = run.frames.time_s.length ? run.states.at(-1).to_s : 0;
  fact('Frames', String(evaluation.frames), `${figure(seconds)} s, ${evaluation.frames_with_pose} with a pose`);
  const {frames_unreadable: unreadable, frames_dropped: dropped} = evaluation;
  fact('Missing pairs, resets', `${evaluation.frames_missing}, ${evaluation.resets}`,
    isKnown(unreadable) ? `${unreadable} unreadable, ${dropped} dropped` : '');
  const confirmed = evaluation.confirmed_object_ids;
  fact('Objects confirmed', String(confirmed.length), confirmed.map((id) => objectName(run, id)).join(', '));
  if (run.latency) {
    fact('Latency, median', `${figure(run.latency.p50_ms, 3)} ms`,
      `p99 ${figure(run.latency.p99_ms, 3)} ms, p99.9 ${figure(run.latency.p999_ms, 3)} ms`);
  }
  const {camera, objects} = evaluation;
  if (camera) {
    fact('Path of the vehicle', `${figure(camera.path_length_m)} m`);
    fact('Local error, mean', inCm(camera.step_m?.mean), inDeg(camera.step_rad?.mean));
    fact('Absolute error, mean', inCm(camera.absolute_m?.mean), inDeg(camera.absolute_rad?.mean));
    // Of a path too short, no share is known.
    fact('Final drift', inCm(camera.final_drift_m),
      isKnown(camera.final_drift_percent) ? `${figure(camera.final_drift_percent)} % of the path` : '');
  }
  if (objects) {
    fact('Right number of motions', percent(objects.right_count_share),
      isKnown(objects.right_count_settled_share) ? `1 s after each appearing ${percent(objects.right_count_settled_share)}` : '');
    fact('False objects', String(objects.false_objects.length));
  }
}

// On paper a table stays with its title.
const titled = (title, ...content) => element('div', {className: 'titled'}, element('h3', {textContent: title}), ...content);

function statisticsRow(name, statistics, factor, unit) {
  if (!statistics) return [name, '-', '-', '-', '-', '-', unit];
  const {count, mean, median, rmse, max} = statistics;
  return [name, ...[mean, median, rmse, max].map((value) => figure(value * factor)), String(count), unit];
}

function errorRows(name, errors) {
  return [
    statisticsRow(`${name}, local displacement`, errors.step_m, CM_PER_M, 'cm'),
    statisticsRow(`${name}, local orientation`, errors.step_rad, DEG_PER_RAD, 'deg'),
    statisticsRow(`${name}, absolute displacement`, errors.absolute_m ?? errors.since_birth_m, CM_PER_M, 'cm'),
    statisticsRow(`${name}, absolute orientation`, errors.absolute_rad ?? errors.since_birth_rad, DEG_PER_RAD, 'deg'),
  ];
}

function neesText(nees) {
  return nees ? `${figure(nees.mean)} (band ${figure(nees.band_low, 3)} to ${figure(nees.band_high, 3)})` : '-';
}

function bodyRow(run, body) {
  return [
    bodyName(run, body.name),
    `${body.frames_covered} of ${body.frames_on_show}`,
    percent(body.coverage),
    String(body.identity_switches),
    !isKnown(body.time_to_detection_s) ? 'never' : `${figure(body.time_to_detection_s, 3)} s`,
    neesText(body.nees),
  ];
}

function showErrorTables(run) {
  const container = byId('error-tables');
  const {camera, objects} = run.evaluation;
  const rows = camera ? errorRows('vehicle', camera) : [];
  for (const body of objects?.bodies ?? []) rows.push(...errorRows(bodyName(run, body.name), body));
  if (rows.length) {
    container.append(titled('Errors', table(['', 'mean', 'median', 'RMSE', 'max', 'frames', 'unit'], rows)));
  }
  if (camera) {
    const {kitti_drift: kitti} = camera;
    const drift = [
      ['ATE, RMSE after alignment', inCm(camera.ate_rmse_m)],
      ['Final drift', `${inCm(camera.final_drift_m)}, ${inDeg(camera.final_drift_rad)}`],
      ['NEES of the step (expected 6)', neesText(camera.nees)],
    ];
    if (kitti) drift.push(['KITTI drift', `${figure(kitti.translation_percent)} %, ${figure(kitti.rotation_deg_per_100m)} deg/100 m`]);
    container.append(titled('Vehicle', table(['', 'value'], drift)));
  }
  if (objects?.bodies.length) {
    container.append(titled('Moving bodies',
      table(['', 'frames covered', 'coverage', 'identity switches', 'detected after', 'NEES of the motion'],
        objects.bodies.map((body) => bodyRow(run, body)))));
  }
  if (objects?.false_objects.length) {
    const place = (object) => (object.resting_body ? `on ${bodyName(run, object.resting_body)}, at rest`
      : object.duplicate ? 'second object on a body that has one' : 'on the background');
    container.append(titled('False objects', table(['', 'frames confirmed', 'where'],
      objects.false_objects.map((object) => [objectName(run, object.object_id), String(object.frames), place(object)]))));
  }
}

function showStageTable(run) {
  const outcomes = Object.keys(run.stages[0].outcomes)
    .filter((outcome) => run.stages.some((stage) => stage.outcomes[outcome] > 0));
  const name = (text) => text.replaceAll('_', ' ');
  byId('stage-table').append(
    element('h3', {textContent: 'Frames by outcome'}),
    table(['stage', ...outcomes.map(name)],
      run.stages.map((stage) => [name(stage.name), ...outcomes.map((outcome) => String(stage.outcomes[outcome]))])),
    element('h3', {textContent: 'Time of each stage'}),
    table(['stage', 'p50 [ms]', 'p99 [ms]', 'max [ms]'],
      run.stages.map((stage) => [name(stage.name), ...[stage.p50_ms, stage.p99_ms, stage.max_ms].map((ms) => figure(ms, 3))])),
  );
}

export function showFacts(run) {
  const {evaluation} = run;
  const title = evaluation.dataset || evaluation.run;
  document.title = `Pelorus report: ${title}`;
  const truth = evaluation.has_truth ? `, truth: ${evaluation.truth_origin}` : '';
  byId('subject').textContent =
    `Run ${evaluation.run}${evaluation.dataset ? `, data set ${evaluation.dataset}` : ''}${truth}`;
  byId('notes').append(...run.notes.map((text) => element('li', {textContent: text})));
  showSummary(run);
  if (evaluation.has_truth) showErrorTables(run);
  showStageTable(run);
}
