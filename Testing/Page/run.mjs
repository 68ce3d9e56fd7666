// Runs a script of this folder, in JavaScript or Python, with Chromium: node run.mjs FOLDER BUNDLE SCRIPT [--test].
// FOLDER receives the packages of package-lock.json, BUNDLE is the folder of the page's bundle. Exits 77 (skipped) where
// Chromium, the packages or the bundle cannot be had.
import { spawnSync } from 'node:child_process';
import { copyFileSync, existsSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { fileURLToPath } from 'node:url';

const [folder, bundle, script, ...options] = process.argv.slice(2);

function skip(why) {
  console.log(`Skipped: ${why}`);
  process.exit(77);
}

/** Installs the packages where the lock has changed. */
function install() {
  const lock = readFileSync(new URL('package-lock.json', import.meta.url), 'utf8');
  const stamp = join(folder, 'installed.txt');
  if (existsSync(stamp) && readFileSync(stamp, 'utf8') === lock) {
    return;
  }
  mkdirSync(folder, { recursive: true });
  for (const name of ['package.json', 'package-lock.json']) {
    copyFileSync(new URL(name, import.meta.url), join(folder, name));
  }
  const npm = spawnSync(
    'npm',
    ['ci', '--ignore-scripts', '--no-audit', '--no-fund', '--prefer-offline', '--fetch-retries=1'],
    { cwd: folder, encoding: 'utf8' }
  );
  if (npm.status !== 0) {
    skip(`npm ci failed: ${npm.stderr?.split('\n')[0] ?? npm.error}`);
  }
  writeFileSync(stamp, lock);
}

/** The path of Chromium's program. */
function chromium() {
  const names = ['chromium-headless-shell', 'chromium', 'chromium-browser', 'google-chrome'];
  const paths = (process.env.PATH ?? '').split(':').flatMap((path) => names.map((name) => join(path, name)));
  return process.env.BONETK_CHROMIUM ?? paths.find((path) => existsSync(path)) ?? skip('there is no Chromium.');
}

if (!existsSync(join(bundle, 'bundle.txt'))) {
  skip('the page was built without its script.');
}
const path = chromium();
install();
const program = script.endsWith('.py') ? (process.env.BONETK_PYTHON ?? 'python3') : process.execPath;
const result = spawnSync(program, [...options, fileURLToPath(new URL(script, import.meta.url))], {
  stdio: 'inherit',
  env: { ...process.env, BONETK_PAGE_MODULES: folder, BONETK_PAGE_BUNDLE: bundle, BONETK_CHROMIUM: path }
});
process.exit(result.status ?? 1);
