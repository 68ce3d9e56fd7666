// The 3D view of a mesh with its controls: regions, colours, cut, contours, landmarks and the camera.
import { decodeArray } from './arrays.js';
import { coloursOfRegions, parseHexColour, regionColour } from './colours.js';
import { planeCut } from './cut.js';
import { button, checkbox, element, group, oncePerFrame, select, slider } from './dom.js';
import { bindInteraction, hint } from './interaction.js';
import { formatNumber, roundStep } from './numbers.js';
import { colourBar, legend, ScaleBar } from './overlay.js';
import { Scene, viewsByName } from './scene.js';
import { regionSurface } from './surface.js';

const planesByName = {
  axial: { normal: [0, 0, 1], axis: 'z' },
  coronal: { normal: [0, 1, 0], axis: 'y' },
  sagittal: { normal: [1, 0, 0], axis: 'x' }
};
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cssColour = (region) => `rgb(${regionColour(region).join(' ')})`;
const capital = (text) => text[0].toUpperCase() + text.slice(1);

export class Viewer {
  /**
   * Fills `container`. description: unit, quantity, range and regions of the page's model or atlas. prefix: what the
   * controls' ids begin with, where a page has two viewers.
   */
  constructor(container, description, prefix = '') {
    this.description = description;
    this.prefix = prefix;
    this.regions = Object.entries(description.regions).map(([number, name]) => ({
      number: Number(number),
      name,
      isShown: true,
      opacity: 1
    }));
    this.plane = { name: 'axial', normal: planesByName.axial.normal, position: 0, isOn: false };
    this.isColouredByDensity = true;
    this.hasCellEdges = false;
    this.frames = 0;
    this.build(container);
    this.updateCut = oncePerFrame(() => this.computeCut());
  }

  build(container) {
    this.stage = element('div', { className: 'stage', id: `${this.prefix}view3d` });
    this.labels = element('div', { className: 'labels' });
    this.scaleBar = new ScaleBar();
    this.keyPlace = element('div', { className: 'key' });
    this.controls = element('div', { className: 'controls' });
    container.className = 'viewer';
    this.column = element(
      'div',
      {},
      element(
        'div',
        { className: 'viewer-picture' },
        this.stage,
        this.keyPlace,
        element('p', { className: 'hint' }, hint)
      )
    );
    container.append(this.column, this.controls);
    try {
      this.scene = new Scene(this.stage, () => this.drawOverlay());
    } catch (error) {
      this.stage.replaceWith(element('p', { className: 'notice' }, error.message));
      throw error;
    }
    this.stage.append(this.labels, this.scaleBar.node);
    const { canvas } = this.scene;
    canvas.tabIndex = 0;
    canvas.setAttribute('role', 'img');
    canvas.setAttribute('aria-label', 'Model in three dimensions; arrow keys turn it, plus and minus zoom');
    bindInteraction(this.scene, { onTurn: () => this.turned(), onFit: () => this.fit() });
    for (const query of ['(prefers-color-scheme: dark)', 'print']) {
      matchMedia(query).addEventListener('change', () => this.applyTheme());
    }
    window.addEventListener('beforeprint', () => this.beginPrint());
    window.addEventListener('afterprint', () => this.printed.remove());
    this.applyTheme();
    this.addControls();
  }

  id(name) {
    return this.prefix + name;
  }

  addControls() {
    const views = Object.keys(viewsByName).map((name) => button(capital(name), () => this.lookFrom(name)));
    this.controls.append(
      group('View', element('div', { className: 'buttons' }, ...views)),
      this.regionsGroup(),
      this.cutGroup()
    );
  }

  regionsGroup() {
    const fieldset = group('Regions', ...this.regions.map((region) => this.regionRow(region)), this.colourRow());
    fieldset.firstChild.append(element('span', { className: 'legend-remark', 'aria-hidden': 'true' }, 'Opacity'));
    return fieldset;
  }

  regionRow(region) {
    const { control, row } = checkbox(this.id(`region-${region.number}`), region.name, true, (isShown) => {
      region.isShown = isShown;
      this.showRegions();
      this.updateCut();
    });
    const opacity = element('input', {
      type: 'range',
      id: this.id(`opacity-${region.number}`),
      min: 0,
      max: 100,
      step: 5,
      value: 100,
      title: 'Opacity',
      'aria-label': `Opacity of ${region.name}, per cent`
    });
    opacity.addEventListener('input', () => {
      region.opacity = opacity.valueAsNumber / 100;
      this.showRegions();
    });
    const swatch = element('span', {
      className: 'swatch',
      style: `background: ${cssColour(region.number)}`,
      'aria-hidden': 'true'
    });
    control.after(swatch);
    row.append(opacity);
    return row;
  }

  colourRow() {
    const { control, row } = select(
      this.id('colour'),
      'Colour by',
      [
        ['density', capital(this.description.quantity)],
        ['region', 'Region']
      ],
      (value) => {
        this.isColouredByDensity = value === 'density';
        this.recolour();
      }
    );
    this.colourControl = control;
    return row;
  }

  cutGroup() {
    const onOff = checkbox(this.id('cut-on'), 'Show a cut', false, (isOn) => this.setCutOn(isOn));
    this.cutOnControl = onOff.control;
    const orientation = select(
      this.id('cut-orientation'),
      'Orientation',
      [
        ['axial', 'Axial'],
        ['coronal', 'Coronal'],
        ['sagittal', 'Sagittal'],
        ['free', 'Free (as seen now)']
      ],
      (name) => this.orientCut(name)
    );
    this.alignControl = button('Cut as seen now', () => this.orientCut('free'), { id: this.id('cut-align') });
    this.alignControl.hidden = true;
    this.cutSlider = slider(
      this.id('cut'),
      'Position',
      { min: 0, max: 1, step: 1, value: 0, say: (mm) => this.sayPosition(mm), live: true },
      (mm) => {
        this.plane.position = mm;
        this.setCutOn(true);
      }
    );
    const edges = checkbox(this.id('cut-edges'), 'Edges of the cells', false, (isOn) => {
      this.hasCellEdges = isOn;
      this.updateCut();
    });
    return group('Cut', onOff.row, orientation.row, this.alignControl, this.cutSlider.row, edges.row);
  }

  sayPosition(mm) {
    const axis = planesByName[this.plane.name]?.axis ?? 'depth';
    return `${axis} = ${formatNumber(mm, 1)} mm`;
  }

  /** Lets the user choose among levels; choose(index) is called. */
  addLevels(names, choose) {
    const { control, row } = select(
      this.id('level'),
      'Level',
      names.map((name, i) => [String(i), name]),
      (value) => choose(Number(value))
    );
    this.levelControl = control;
    this.levelText = element('p', { className: 'remark' });
    this.controls.prepend(group('Detail', row, this.levelText));
  }

  /** Adds the page's contours and landmarks, with a checkbox each. */
  async addExtras(contours = [], landmarks = []) {
    const rows = [];
    for (const contour of contours) {
      const [counts, closed, points] = await Promise.all(
        [contour.counts, contour.closed, contour.points].map(decodeArray)
      );
      const name = contour.name.endsWith('axis') ? contour.name : `${contour.name} contours`;
      this.scene.addContours(name, parseHexColour(contour.color), points, polylines(counts, closed));
      this.scene.setContoursShown(name, false);
      const { control, row } = checkbox(this.id(`contours-${rows.length + 1}`), capital(name), false, (isShown) =>
        this.scene.setContoursShown(name, isShown)
      );
      control.after(
        element('span', { className: 'swatch', style: `background: ${contour.color}`, 'aria-hidden': 'true' })
      );
      rows.push(row);
    }
    if (landmarks.length > 0) {
      rows.push(this.landmarksRow(landmarks));
    }
    if (rows.length > 0) {
      this.controls.append(group('Also show', ...rows));
    }
  }

  landmarksRow(landmarks) {
    this.landmarks = landmarks.map(({ name, position }) => ({ position, label: element('span', {}, name) }));
    this.labels.append(...this.landmarks.map(({ label }) => label));
    const [left, right, front, back, low, high] = this.bounds();
    const radius = 0.008 * Math.hypot(right - left, back - front, high - low);
    landmarks.forEach(({ position }) => this.scene.addLandmark(position, radius, [0.86, 0.2, 0.18]));
    const { row } = checkbox(this.id('landmarks'), 'Landmarks', false, (isShown) => this.showLandmarks(isShown));
    this.showLandmarks(false);
    return row;
  }

  showLandmarks(isShown) {
    this.labels.hidden = !isShown;
    this.scene.setLandmarksShown(isShown);
  }

  bounds() {
    return [
      [1, 0, 0],
      [0, 1, 0],
      [0, 0, 1]
    ].flatMap((axis) => this.mesh.extent(axis));
  }

  /** Shows a mesh. isMoved: the mesh is the one before with other points or densities. */
  setMesh(mesh, isMoved = false) {
    const isFirst = !this.mesh;
    this.mesh = mesh;
    if (!mesh.hasDensity) {
      this.isColouredByDensity = false;
      this.colourControl.value = 'region';
      this.colourControl.disabled = true;
    }
    this.computeSurfaces();
    if (!isMoved) {
      this.setCutRange();
    }
    if (isFirst) {
      this.showKey();
      this.scene.resize();
      this.lookFrom('anterior');
      this.fit();
    }
    if (this.levelText) {
      const [cells, points] = [mesh.cellCount, mesh.points.length / 3].map((count) => count.toLocaleString('en'));
      this.levelText.textContent = `${cells} cells, ${points} points`;
    }
    this.updateCut();
  }

  computeSurfaces() {
    for (const region of this.regions) {
      region.surface = regionSurface(this.mesh, region.number);
      this.scene.setSurface(
        region.number,
        region.surface,
        this.colouringOf(new Uint8Array(region.surface.points.length / 9).fill(region.number))
      );
    }
    this.showRegions();
  }

  /** How triangles of these regions are coloured. */
  colouringOf(regions) {
    return this.isColouredByDensity ? { range: this.description.range } : { colours: coloursOfRegions(regions) };
  }

  recolour() {
    this.showKey();
    for (const region of this.regions) {
      this.scene.setSurface(
        region.number,
        region.surface,
        this.colouringOf(new Uint8Array(region.surface.points.length / 9).fill(region.number))
      );
    }
    this.updateCut();
  }

  /** The colour bar of the density, or the regions' colours. */
  showKey() {
    this.keyPlace.replaceChildren(
      this.isColouredByDensity
        ? colourBar({ ...this.description, quantity: capital(this.description.quantity) })
        : legend(this.regions.map(({ number, name }) => [name, cssColour(number)]))
    );
  }

  showRegions() {
    this.regions.forEach(({ number, isShown, opacity }) => this.scene.setRegion(number, isShown, opacity));
  }

  /** Fits the position slider to the mesh along the plane's normal. */
  setCutRange() {
    const [low, high] = this.mesh.extent(this.plane.normal);
    const step = roundStep((high - low) / 200);
    const { control } = this.cutSlider;
    const isInside = this.plane.isOn && this.plane.position > low && this.plane.position < high;
    const position = isInside ? this.plane.position : (low + high) / 2;
    Object.assign(control, { min: Math.floor(low / step) * step, max: Math.ceil(high / step) * step, step });
    control.value = position;
    this.plane.position = control.valueAsNumber;
    this.cutSlider.show();
  }

  setCutOn(isOn) {
    if (isOn && !this.plane.isOn) {
      this.turnTowardsCut();
    }
    this.plane.isOn = isOn;
    this.cutOnControl.checked = isOn;
    this.updateCut();
  }

  orientCut(name) {
    this.plane.name = name;
    this.plane.normal = name === 'free' ? this.scene.direction() : planesByName[name].normal;
    this.plane.isOn = false;
    this.alignControl.hidden = name !== 'free';
    this.setCutRange();
    this.setCutOn(true);
  }

  /** Turns the camera where it sees the cut edge-on. */
  turnTowardsCut() {
    const { name, normal } = this.plane;
    if (Math.abs(dot(normal, this.scene.direction())) < 0.2) {
      this.scene.turn(name === 'sagittal' ? 50 : 0, name === 'sagittal' ? 0 : 50);
      if (Math.abs(dot(normal, this.scene.direction())) < 0.2) {
        this.scene.turn(50, 35);
      }
    }
  }

  computeCut() {
    if (!this.plane.isOn) {
      this.cut = null;
      this.scene.setCut(null);
      return;
    }
    const shown = new Set(this.regions.filter((region) => region.isShown).map((region) => region.number));
    const { normal, position } = this.plane;
    this.cut = planeCut(this.mesh, normal, position, (region) => shown.has(region));
    const origin = normal.map((component) => component * position);
    this.clippedSide = dot(normal, this.scene.direction()) >= 0 ? 1 : -1;
    this.scene.setCut(
      this.cut,
      this.colouringOf(this.cut.regions),
      this.hasCellEdges,
      origin,
      normal.map((component) => component * this.clippedSide)
    );
  }

  /** Clips away the side of the cut that has come to lie in front. */
  turned() {
    const towards = this.plane.isOn ? dot(this.plane.normal, this.scene.direction()) : 0;
    if (towards * this.clippedSide < -0.02) {
      this.updateCut();
    }
  }

  lookFrom(name) {
    this.scene.lookFrom(name);
    this.turned();
  }

  fit() {
    this.scene.fit(this.bounds());
  }

  applyTheme() {
    const channels = getComputedStyle(this.stage)
      .backgroundColor.match(/[\d.]+/g)
      .map(Number);
    this.scene.setBackground(channels.slice(0, 3).map((channel) => channel / 255));
  }

  /** Puts a copy of the picture on white in its place: browsers print what WebGL has drawn for the screen. */
  beginPrint() {
    this.scene.setBackground([1, 1, 1]);
    const { canvas } = this.scene;
    this.printed = element('canvas', { className: 'printed', width: canvas.width, height: canvas.height });
    this.printed.getContext('2d').drawImage(canvas, 0, 0);
    canvas.after(this.printed);
  }

  drawOverlay() {
    const { width, height } = this.stage.getBoundingClientRect();
    this.stage.style.setProperty('--aspect', width / height);
    this.scaleBar.update(this.scene.millimetresPerPixel(), width);
    for (const { position, label } of this.landmarks ?? []) {
      const [x, y] = this.scene.project(position);
      label.style.left = `${((100 * x) / width).toFixed(3)}%`;
      label.style.top = `${((100 * y) / height).toFixed(3)}%`;
    }
  }
}

/** vtk's cells of polylines of `counts` points each, closed ones back to their first point. */
function polylines(counts, closed) {
  const cells = [];
  let begin = 0;
  counts.forEach((count, line) => {
    const isClosed = closed[line] !== 0;
    cells.push(count + (isClosed ? 1 : 0));
    for (let i = 0; i < count; ++i) {
      cells.push(begin + i);
    }
    if (isClosed) {
      cells.push(begin);
    }
    begin += count;
  });
  return Uint32Array.from(cells);
}
