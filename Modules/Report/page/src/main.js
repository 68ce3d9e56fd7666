// Fills the report page's viewer, slices and atlas from the data the page holds.
import { Atlas } from './atlas.js';
import { Mesh } from './mesh.js';
import { Slices } from './slices.js';
import { Viewer } from './viewer.js';

/** What tests and curious readers may use: window.bonetkPage. */
const page = {
  /** The index of the level that is shown. */
  level: 0,
  /** Milliseconds from the start of the page's loading to its first frame; NaN until then. */
  frameTime: NaN,
  viewer: null,
  slices: null,
  atlas: null,
  /** The present cut, as cut.js makes it; null where there is none. */
  cut: () => page.viewer.cut,
  /** Looks from anterior, posterior, left, right, superior or inferior. */
  lookFrom: (name) => page.viewer.lookFrom(name),
  /** The position in the canvas, in CSS pixels from its upper left corner, of a point in LPS mm. */
  project: (point) => page.viewer.scene.project(point)
};

async function showModel(container, model) {
  const viewer = new Viewer(container, model);
  const meshes = [];
  const setLevel = async (index) => {
    meshes[index] ??= await Mesh.decode(model.levels[index]);
    page.level = index;
    viewer.setMesh(meshes[index]);
  };
  viewer.addLevels(
    model.levels.map(({ name }) => name),
    setLevel
  );
  await setLevel(0);
  await viewer.addExtras(model.contours, model.landmarks);
  page.viewer = viewer;
}

/** Runs one of the page's parts; where it fails, its place says why and the others go on. */
async function attempt(container, work) {
  try {
    await work();
  } catch (error) {
    const notice = document.createElement('p');
    notice.className = 'notice';
    notice.textContent = error.message;
    container.prepend(notice);
    console.warn(error);
  }
}

async function start() {
  const data = JSON.parse(document.getElementById('bonetk-data').textContent);
  const place = (name) => document.getElementById(name);
  window.bonetkPage = page;
  const parts = [];
  if (data.model && place('viewer')) {
    parts.push(attempt(place('viewer'), () => showModel(place('viewer'), data.model)));
  }
  if (data.slices && place('slices')) {
    parts.push(
      attempt(place('slices'), async () => {
        page.slices = await Slices.create(place('slices'), data.slices);
      })
    );
  }
  await Promise.all(parts);
  if (data.atlas && place('atlas')) {
    await attempt(place('atlas'), async () => {
      page.atlas = await Atlas.create(place('atlas'), data.atlas, data.model ? 'atlas-' : '');
      page.viewer ??= page.atlas.viewer;
    });
  }
  requestAnimationFrame(() =>
    requestAnimationFrame(() => {
      page.frameTime = performance.now();
      document.title = `BoneTK report: ${data.name} \u2013 rendered`;
    })
  );
}

start();
