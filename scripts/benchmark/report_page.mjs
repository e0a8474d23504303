// Opens a report, turns it for some seconds and prints the times as JSON:
// node report_page.mjs PACKAGES CHROMIUM REPORT.html
import { createRequire } from 'node:module';
import { pathToFileURL } from 'node:url';

const [packages, executablePath, reportPath] = process.argv.slice(2);
const { chromium } = createRequire(`${packages}/`)('playwright-core');
const TURN_S = 5;

const browser = await chromium.launch({
  executablePath,
  args: [
    '--headless',
    '--no-sandbox',
    '--disable-gpu',
    '--disable-quic',
    '--no-first-run',
    '--disable-background-networking',
    '--disable-component-update',
    '--disable-sync',
    '--use-angle=swiftshader',
    '--enable-unsafe-swiftshader',
  ],
});
const page = await browser.newPage({ viewport: { width: 1400, height: 900 } });
// Notes in the page itself when things show: performance.now() counts from the navigation.
await page.addInitScript(() => {
  window.shownAt = {};
  const look = () => {
    const parts = window.plumbline;
    const note = (name) => {
      window.shownAt[name] ??= performance.now() / 1000;
    };
    if (document.querySelector('.verdict h1')) note('verdict_s');
    if (parts?.isReady && parts.view.frames > 0) note('open_s');
    if (parts?.isReady && parts.view.numDrawn >= parts.view.cloud.points.count)
      note('all_points_s');
    else requestAnimationFrame(look);
  };
  requestAnimationFrame(look);
});
await page.goto(pathToFileURL(reportPath).href);
await page.waitForFunction(() => window.shownAt.all_points_s, null, { timeout: 120_000 });
const shown = await page.evaluate(() => window.shownAt);

// Turns as fast as frames come, a little each time, and counts the frames that were drawn. The
// first second lets the page find how many points it can draw in time.
const turn = await page.evaluate(
  (seconds) =>
    new Promise((resolve) => {
      const { view } = window.plumbline;
      const gaps = [];
      let before = 0;
      let start = 0;
      const step = (now) => {
        start ||= now;
        if (now - start > 1000) gaps.push(now - before);
        before = now;
        if (now - start > 1000 * (1 + seconds)) {
          resolve({ gaps, points: view.numMoving });
          return;
        }
        view.eye.turn(1, 0);
        requestAnimationFrame(step);
      };
      requestAnimationFrame(step);
    }),
  TURN_S,
);
const total = turn.gaps.reduce((sum, gap) => sum + gap, 0) / 1000;
const size = await page.evaluate(() => {
  const { view } = window.plumbline;
  return { points: view.cloud.points.count, width: view.canvas.width, height: view.canvas.height };
});
console.log(
  JSON.stringify({
    browser: `Chromium ${browser.version()}`,
    ...size,
    ...shown,
    turn_hz: turn.gaps.length / total,
    turn_worst_s: Math.max(...turn.gaps) / 1000,
    turn_points: turn.points,
  }),
);
await browser.close();
