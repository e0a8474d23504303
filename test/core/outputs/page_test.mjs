// Uses a report in Chromium: node page_test.mjs PACKAGES CHROMIUM REPORT.html EXPECTED.json
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';

const [packages, chromiumPath, reportPath, expectedPath] = process.argv.slice(2);
const { chromium } = createRequire(`${packages}/`)('playwright-core');
const expected = JSON.parse(readFileSync(expectedPath, 'utf8'));
const url = pathToFileURL(reportPath).href;

const FLAGS = [
  '--headless',
  '--no-sandbox',
  '--disable-gpu',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];
// Draws in software.
const WITH_WEBGL = [...FLAGS, '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
const WITHOUT_WEBGL = [...FLAGS, '--disable-3d-apis'];

function near(found, wanted, tolerance, what) {
  assert.ok(
    Math.abs(found - wanted) <= tolerance,
    `${what}: ${found}, expected ${wanted} ± ${tolerance}`,
  );
}

// Half of a text's last digit.
const rounding = (text) => 0.501 * 10 ** -(text.split('.')[1] ?? '').length;

// Holds a text such as "1.0004 m ± 1.2 mm" or "90.003° ± 0.012°" against m or degrees.
function checkStated(text, value, stddev, what) {
  const found = /(-?[\d.]+)(?: m|°) ± ([\d.]+)( mm|°)/.exec(text);
  assert.ok(found, `no value with a standard deviation: ${text}`);
  const scale = found[3] === ' mm' ? 1000 : 1;
  near(Number(found[1]), value, rounding(found[1]), what);
  near(Number(found[2]), scale * stddev, rounding(found[2]), `standard deviation of the ${what}`);
}

// Opens the report; fails on what the console says is an error, and on any request to a network.
async function open(flags, viewport, check) {
  const browser = await chromium.launch({ executablePath: chromiumPath, args: flags });
  try {
    const page = await browser.newPage({ viewport });
    const complaints = [];
    page.on('console', (message) => {
      if (message.type() === 'error') complaints.push(message.text());
    });
    page.on('pageerror', (error) => complaints.push(error.message));
    page.on('request', (request) => {
      if (!/^(file|blob|data):/.test(request.url())) complaints.push(request.url());
    });
    await page.goto(url);
    await page.waitForFunction(() => window.plumbline?.isReady, null, { timeout: 30_000 });
    await check(page);
    assert.deepEqual(complaints, []);
  } finally {
    await browser.close();
  }
}

const drawn = (page) =>
  page.waitForFunction(
    () => window.plumbline.view.numDrawn >= window.plumbline.view.cloud.points.count,
  );

async function checkWords(page) {
  const { summary, planes } = expected;
  assert.equal((await page.textContent('.verdict h1')).toLowerCase(), summary.consistency.verdict);
  const warnings = await page.locator('.warnings li').count();
  assert.ok(warnings >= summary.warnings.length);
  assert.equal(await page.locator('#surfaces tbody tr').count(), planes.length);
  const figures = await page.textContent('.figures');
  assert.ok(figures.includes(summary.points.toLocaleString('en-US')), figures);
  assert.ok(figures.includes(`${(1000 * summary.residual_rms_m).toPrecision(3)} mm`), figures);
  const errors = await page.textContent('#errors');
  assert.ok(errors.includes(`${expected.evaluation.planes.matched} surfaces match`), errors);
  assert.ok(
    errors.includes((1000 * expected.evaluation.planes.distance_m.rmse).toPrecision(3)),
    errors,
  );
}

async function checkPoints(page) {
  const found = await page.evaluate(() => {
    const { points, report } = window.plumbline;
    const { place, moment, count, origin, step_m: step, time_step_s: timeStep } = points;
    const sums = [0, 0, 0];
    const byScanner = [];
    const byPlane = {};
    let last = 0;
    for (let i = 0; i < count; ++i) {
      for (let axis = 0; axis < 3; ++axis) sums[axis] += origin[axis] + step * place[4 * i + axis];
      const field = place[4 * i + 3];
      const id = field < 2 ? -1 - field : report.planes[field - 2].id;
      byPlane[id] = (byPlane[id] ?? 0) + 1;
      byScanner[moment[2 * i + 1]] = (byScanner[moment[2 * i + 1]] ?? 0) + 1;
      last = Math.max(last, timeStep * moment[2 * i]);
    }
    return { count, mean: sums.map((sum) => sum / count), byScanner, byPlane, last, step };
  });
  const { points } = expected;
  assert.equal(found.count, points.count);
  found.mean.forEach((x, axis) =>
    near(x, points.mean[axis], 0.1 * found.step, 'mean of the points'),
  );
  near(found.last, points.last_time, 0.002, 'last time');
  assert.deepEqual(found.byScanner, points.by_scanner);
  assert.deepEqual(found.byPlane, points.by_plane);
  const statistics = await page.evaluate(() => window.plumbline.report.statistics);
  const used = statistics.by_scanner.reduce((sum, group) => sum + group[1], 0);
  const squares = statistics.by_scanner.reduce((sum, group) => sum + group[1] * group[2] ** 2, 0);
  near(Math.sqrt(squares / used), points.residual_rms, 1e-7, 'RMS of the residuals');
}

async function checkSurfaces(page) {
  for (const plane of expected.planes.slice(0, 4)) {
    await page.getByRole('button', { name: `choose surface ${plane.id}`, exact: true }).click();
    const box = page.locator(`.surface[data-id="${plane.id}"]`);
    checkStated(
      await box.locator('dd').nth(1).textContent(),
      plane.distance,
      plane.sigma_distance_m,
      `distance of surface ${plane.id}`,
    );
    assert.ok((await box.textContent()).includes(plane.num_points.toLocaleString('en-US')));
    if (plane.sigma_angle_deg > 0) {
      assert.ok((await box.textContent()).includes(`± ${plane.sigma_angle_deg.toFixed(4)}°`));
    }
  }
}

async function checkMeasures(page) {
  const exact = await page.evaluate((pairs) => {
    const { surfaces } = window.plumbline;
    return pairs.map(({ a, b }) => {
      const { angle, distance } = surfaces.between(surfaces.find(a), surfaces.find(b), null);
      return [angle.value, angle.stddev, distance.value, distance.stddev];
    });
  }, expected.measurements);
  expected.measurements.forEach(({ a, b, angle, distance }, i) => {
    [...angle, ...distance].forEach((wanted, k) =>
      near(
        exact[i][k],
        wanted,
        1e-6 * Math.abs(wanted) + 1e-9,
        `number ${k} between ${a} and ${b}`,
      ),
    );
  });
  const choose = (id) => page.getByRole('button', { name: `choose surface ${id}`, exact: true });
  for (const { a, b, angle, distance } of [expected.measurements[0], expected.measurements[7]]) {
    await choose(a).click();
    await choose(b).click({ modifiers: ['Shift'] });
    checkStated(await page.textContent('#measured-distance'), ...distance, 'distance measured');
    checkStated(
      await page.textContent('#measured-angle'),
      ...angle.map((x) => (x * 180) / Math.PI),
      'angle measured',
    );
  }
  // The same with the button, as on a screen that is touched.
  const { a, b } = expected.measurements[0];
  await choose(a).click();
  await page.click('#measure');
  await choose(b).click();
  assert.deepEqual(await page.evaluate(() => window.plumbline.surfaces.chosen), [a, b]);
  await page.keyboard.press('Escape');
  assert.deepEqual(await page.evaluate(() => window.plumbline.surfaces.chosen), []);
}

// A click into the picture chooses what is drawn there.
async function checkPicking(page) {
  await page.keyboard.press('t');
  await drawn(page);
  const floor = expected.planes
    .filter((plane) => plane.type === 'horizontal' && plane.normal[2] > 0)
    .sort((x, y) => y.num_points - x.num_points)[0];
  const place = await page.evaluate((id) => {
    const { points, report, view } = window.plumbline;
    const field = 2 + report.planes.findIndex((plane) => plane.id === id);
    // Of its points, one near the middle of the picture.
    let best = null;
    for (let i = 0; i < points.count; i += 7) {
      if (points.place[4 * i + 3] !== field) continue;
      const world = points.origin.map((x, axis) => x + points.step_m * points.place[4 * i + axis]);
      const at = view.eye.project(world);
      const off = Math.hypot(
        at.x - view.canvas.clientWidth / 2,
        at.y - view.canvas.clientHeight / 2,
      );
      if (!best || off < best.off) best = { ...at, off };
    }
    return best;
  }, floor.id);
  await page.locator('#view').click({ position: { x: place.x, y: place.y } });
  assert.deepEqual(await page.evaluate(() => window.plumbline.surfaces.chosen), [floor.id]);
  await page.locator('#view').click({ position: { x: 3, y: 3 } });
  assert.deepEqual(await page.evaluate(() => window.plumbline.surfaces.chosen), []);
  const wall = page.locator('.plan .wall').first();
  const id = Number(await wall.getAttribute('data-id'));
  await wall.dispatchEvent('click');
  assert.deepEqual(await page.evaluate(() => window.plumbline.surfaces.chosen), [id]);
}

const picture = async (page) => {
  await drawn(page);
  return (await page.locator('#view').screenshot()).toString('base64');
};

async function checkKeysAndControls(page) {
  await page.focus('#view');
  await page.keyboard.press('o');
  let before = await picture(page);
  const changes = async (what, act) => {
    await act();
    const after = await picture(page);
    assert.notEqual(after, before, `${what} changes nothing`);
    before = after;
  };
  for (const key of ['2', '3', '4', '5'])
    await changes(`colouring ${key}`, () => page.keyboard.press(key));
  assert.equal(await page.getAttribute('[data-colour=residual]', 'aria-pressed'), 'true');
  await changes('a button for scanners', () => page.click('[data-colour=scanner]'));
  assert.deepEqual(
    await page.locator('.legend span').allTextContents(),
    expected.summary.scanners,
  );
  await changes('a button for a colour', () => page.click('[data-colour=surface]'));
  await changes('an arrow', () =>
    page.keyboard.press('ArrowLeft').then(() => page.click('[data-view=front]')),
  );
  await page.focus('#view');
  await changes('turning', () => page.keyboard.press('ArrowUp'));
  await changes('zoom', () => page.keyboard.press('+'));
  await changes('backs', () => page.keyboard.press('b'));
  await changes('the height', () => page.locator('#height-high').fill('0.2'));
  assert.ok((await page.textContent('#heights')).includes('0.20 m'));
  await page.focus('#view');
  await page.keyboard.press('PageDown');
  assert.ok((await page.textContent('#heights')).includes('0.10 m'));
  await changes('outlines', () => page.uncheck('#outlines'));
  await changes('points', () => page.uncheck('#points-shown'));
  await page.check('#points-shown');
  const camera = () => page.evaluate(() => window.plumbline.view.eye.position);
  const place = await camera();
  const box = await page.locator('#view').boundingBox();
  await page.mouse.move(box.x + 300, box.y + 200);
  await page.mouse.down();
  await page.mouse.move(box.x + 400, box.y + 220, { steps: 4 });
  await page.mouse.up();
  assert.notDeepEqual(await camera(), place);
}

async function checkTime(page) {
  for (const [t, x, y, z] of expected.poses) {
    const at = await page.evaluate((time) => {
      const { timeline, plan } = window.plumbline;
      timeline.set(time);
      const centre = [plan.rig.getAttribute('cx'), plan.rig.getAttribute('cy')];
      return {
        readout: timeline.readout.textContent,
        t: timeline.t,
        centre,
        body: window.plumbline.view.drawings.body.geometry.attributes.position.array,
      };
    }, t - expected.start);
    near(at.t, t - expected.start, 0.001, 'time of the slider');
    assert.ok(at.readout.startsWith(`${(t - expected.start).toFixed(2)} s`), at.readout);
    const corners = Object.values(at.body);
    [x, y, z].forEach((wanted, axis) => {
      const mean =
        corners.filter((_, i) => i % 3 === axis).reduce((sum, c) => sum + c, 0) /
        (corners.length / 3);
      near(mean, wanted, 0.002, 'place of the rig');
    });
  }
  await page.evaluate(() => window.plumbline.timeline.set(2));
  let before = await picture(page);
  await page.selectOption('#time-mode', 'until');
  assert.notEqual(await picture(page), before, 'points until then are all points');
  await page.selectOption('#rate', '1');
  await page.click('#play');
  await page.waitForFunction(() => window.plumbline.timeline.t > 2.2);
  await page.click('#play');
  assert.equal(await page.evaluate(() => window.plumbline.timeline.playing), false);
  await page.selectOption('#time-mode', 'all');
  // A plot takes to its time.
  const plot = page.locator('.plot svg').nth(4);
  await plot.click({ position: { x: (await plot.boundingBox()).width / 2, y: 60 } });
  near(
    await page.evaluate(() => window.plumbline.timeline.t),
    expected.summary.duration_s / 2,
    1,
    'time clicked in a plot',
  );
}

async function checkFloorPlan(page) {
  const image = page.locator('.floor-plan img');
  assert.equal(await image.count(), 1);
  assert.ok(
    (await image.evaluate((element) => element.decode().then(() => element.naturalWidth))) > 0,
  );
  assert.equal(await page.evaluate(() => window.floorPlanRan), undefined);
}

async function checkNarrow(page) {
  await drawn(page);
  const width = await page.evaluate(() => document.scrollingElement.scrollWidth);
  assert.ok(width <= 390, `the page is ${width} pixels wide on a screen of 390`);
  for (const id of ['#view', '#play', '#measure', '[data-colour=height]']) {
    const box = await page.locator(id).boundingBox();
    assert.ok(box && box.x >= 0 && box.x + box.width <= 390.5, `${id} is out of the screen`);
  }
}

async function checkWithoutWebgl(page) {
  assert.ok((await page.textContent('.stage')).includes('no WebGL 2'));
  assert.equal(await page.locator('#surfaces tbody tr').count(), expected.planes.length);
  await page
    .getByRole('button', { name: `choose surface ${expected.planes[0].id}`, exact: true })
    .click();
  assert.equal(await page.locator('.surface').count(), 1);
}

await open(WITH_WEBGL, { width: 1000, height: 640 }, async (page) => {
  for (const check of [
    checkWords,
    checkPoints,
    checkSurfaces,
    checkMeasures,
    checkPicking,
    checkKeysAndControls,
    checkTime,
    checkFloorPlan,
  ]) {
    const start = Date.now();
    await check(page);
    console.log(`${check.name} passed in ${Date.now() - start} ms`);
  }
});
await open(WITH_WEBGL, { width: 390, height: 800 }, checkNarrow);
await open(WITHOUT_WEBGL, { width: 1000, height: 700 }, checkWithoutWebgl);
console.log('all checks passed');
