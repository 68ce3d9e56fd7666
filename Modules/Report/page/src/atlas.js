// The statistical model: its mean, changed by modes of shape and density, and the changed model's radiograph.
import { decodeArray } from './arrays.js';
import { button, element, group, slider } from './dom.js';
import { Mesh } from './mesh.js';
import { combine } from './modes.js';
import { formatNumber } from './numbers.js';
import { colourBar, ScaleBar } from './overlay.js';
import { coarserView, radiograph } from './radiograph.js';
import { directionLetters, pictureFrame } from './slices.js';
import { Viewer } from './viewer.js';

const reducedMotion = matchMedia('(prefers-reduced-motion: reduce)');

export class Atlas {
  static async create(container, data, prefix) {
    const decode = (modes, name) => Promise.all((modes ?? []).map((mode) => decodeArray(mode[name])));
    const [mean, shape, density] = await Promise.all([
      Mesh.decode(data.mean),
      decode(data.shape, 'displacements'),
      decode(data.density, 'coefficients')
    ]);
    return new Atlas(container, data, prefix, { mean, shape, density });
  }

  constructor(container, data, prefix, { mean, shape, density }) {
    this.data = data;
    this.mean = mean;
    this.modes = [
      ...shape.map((change, i) => ({ kind: 'shape', number: i + 1, share: data.shape[i].share, change, weight: 0 })),
      ...density.map((change, i) => ({
        kind: 'density',
        number: i + 1,
        share: data.density[i].share,
        change,
        weight: 0
      }))
    ];
    this.viewer = new Viewer(container, data, prefix);
    this.viewer.controls.prepend(this.modesGroup());
    if (data.view && mean.hasDensity) {
      this.addRadiograph();
    }
    this.viewer.setMesh(mean);
    this.update();
  }

  modesGroup() {
    const rows = this.modes.map((mode) => {
      const { kind, number, share } = mode;
      const label = `${kind} ${number}, ${(100 * share).toFixed(share < 0.0095 ? 1 : 0)} %`;
      const say = (deviations) => `${deviations > 0 ? '+' : ''}${formatNumber(deviations, 1)} SD`;
      mode.slider = slider(`mode-${kind}-${number}`, label, { min: -3, max: 3, step: 0.1, value: 0, say }, (weight) => {
        this.stop();
        mode.weight = weight;
        this.update();
      });
      return mode.slider.row;
    });
    this.animateControl = button('Animate', () => (this.animation ? this.stop() : this.animate()), {
      id: 'atlas-animate'
    });
    const buttons = element(
      'div',
      { className: 'buttons buttons-two' },
      this.animateControl,
      button('Reset', () => this.reset(), { id: 'atlas-reset' })
    );
    return group('Modes, with their share of the variance', ...rows, buttons);
  }

  reset() {
    this.stop();
    this.modes.forEach((mode) => this.setWeight(mode, 0));
    this.update();
  }

  setWeight(mode, weight) {
    mode.weight = weight;
    mode.slider.control.value = weight;
    mode.slider.show();
  }

  /** Swings the mode that differs most from the mean (at first the first one) between -2 and 2 standard deviations. */
  animate() {
    const mode = this.modes.reduce((most, other) => (Math.abs(other.weight) > Math.abs(most.weight) ? other : most));
    const begin = performance.now() - 1000 * Math.asin(Math.max(-1, Math.min(1, mode.weight / 2)));
    const period = reducedMotion.matches ? 4000 : 1000;
    const frame = (now) => {
      this.setWeight(mode, Math.round(20 * Math.sin((now - begin) / period)) / 10);
      this.update();
      this.animation = requestAnimationFrame(frame);
    };
    this.animateControl.textContent = 'Stop';
    this.animation = requestAnimationFrame(frame);
  }

  stop() {
    cancelAnimationFrame(this.animation);
    this.animation = null;
    this.animateControl.textContent = 'Animate';
    this.drawRadiographSoon();
  }

  update() {
    const of = (kind) => this.modes.filter((mode) => mode.kind === kind);
    const sum = (values, modes) =>
      combine(
        values,
        modes.map(({ change }) => change),
        modes.map(({ weight }) => weight)
      );
    this.mesh = this.mean.with({
      points: sum(this.mean.points, of('shape')),
      coefficients: this.mean.hasDensity ? sum(this.mean.coefficients, of('density')) : null
    });
    this.viewer.setMesh(this.mesh, true);
    this.drawRadiographSoon();
  }

  addRadiograph() {
    const [columns, rows] = this.data.view.size;
    this.canvas = element('canvas', {
      role: 'img',
      'aria-label': "Radiograph of the model as the modes' sliders stand"
    });
    this.scaleBar = new ScaleBar();
    this.barPlace = element('div');
    this.frame = pictureFrame(
      columns * this.data.view.spacing[0],
      rows * this.data.view.spacing[1],
      '60vh',
      this.canvas,
      ...directionLetters(this.data.letters),
      this.scaleBar.node
    );
    this.viewer.column.append(
      element(
        'figure',
        { className: 'radiograph' },
        this.frame,
        this.barPlace,
        element(
          'figcaption',
          {},
          'Radiograph of the model above: line integrals of its density, computed in this page. ' +
            'The scale bar holds in the plane of the detector.'
        )
      )
    );
    new ResizeObserver(() => this.scaleRadiograph()).observe(this.frame);
  }

  scaleRadiograph() {
    const { width } = this.frame.getBoundingClientRect();
    if (width > 0) {
      this.scaleBar.update((this.data.view.size[0] * this.data.view.spacing[0]) / width, width);
    }
  }

  /** A coarse radiograph at once, the fine one when the sliders rest. */
  drawRadiographSoon() {
    if (!this.canvas) {
      return;
    }
    clearTimeout(this.waiting);
    if (!this.isCoarse) {
      this.isCoarse = true;
      setTimeout(() => {
        this.isCoarse = false;
        this.drawRadiograph(coarserView(this.data.view, 4));
      });
    }
    this.waiting = setTimeout(() => this.drawRadiograph(this.data.view), 250);
  }

  /** In grey values of one range, that of the mean and a fifth more: a denser bone is brighter. */
  drawRadiograph(view) {
    const integrals = radiograph(this.mesh, view);
    this.range ??= integrals.reduce(
      ([low, high], value) => [Math.min(low, value), Math.max(high, 1.2 * value)],
      [0, 0]
    );
    const { range } = this;
    this.canvas.width = view.size[0];
    this.canvas.height = view.size[1];
    const context = this.canvas.getContext('2d');
    const image = context.createImageData(...view.size);
    integrals.forEach((value, i) => {
      image.data.fill((255 * (value - range[0])) / (range[1] - range[0]), 4 * i, 4 * i + 3);
      image.data[4 * i + 3] = 255;
    });
    context.putImageData(image, 0, 0);
    const unit = this.data.unit ? `${this.data.unit}\u00b7mm` : 'mm';
    this.barPlace.replaceChildren(
      colourBar({ quantity: 'Line integral', unit, range }, 'linear-gradient(to right, #000, #fff)')
    );
  }
}
