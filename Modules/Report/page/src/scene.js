// What vtk.js draws: surfaces, cut, contours, landmarks and the orientation cube, seen by a parallel projection.
import '@kitware/vtk.js/Rendering/OpenGL/Profiles/Geometry.js';
import vtkDataArray from '@kitware/vtk.js/Common/Core/DataArray.js';
import vtkPlane from '@kitware/vtk.js/Common/DataModel/Plane.js';
import vtkPolyData from '@kitware/vtk.js/Common/DataModel/PolyData.js';
import vtkSphereSource from '@kitware/vtk.js/Filters/Sources/SphereSource.js';
import vtkActor from '@kitware/vtk.js/Rendering/Core/Actor.js';
import vtkAnnotatedCubeActor from '@kitware/vtk.js/Rendering/Core/AnnotatedCubeActor.js';
import vtkMapper from '@kitware/vtk.js/Rendering/Core/Mapper.js';
import vtkRenderer from '@kitware/vtk.js/Rendering/Core/Renderer.js';
import vtkRenderWindow from '@kitware/vtk.js/Rendering/Core/RenderWindow.js';
import vtkOpenGLRenderWindow from '@kitware/vtk.js/Rendering/OpenGL/RenderWindow.js';
import { oncePerFrame } from './dom.js';
import { densityAttributeNames, densityAttributes, densityShader } from './shader.js';

/** Where the camera stands (from the model's centre) and what is up, in LPS. */
export const viewsByName = {
  anterior: { direction: [0, -1, 0], up: [0, 0, 1] },
  posterior: { direction: [0, 1, 0], up: [0, 0, 1] },
  left: { direction: [1, 0, 0], up: [0, 0, 1] },
  right: { direction: [-1, 0, 0], up: [0, 0, 1] },
  superior: { direction: [0, 0, 1], up: [0, -1, 0] },
  inferior: { direction: [0, 0, -1], up: [0, -1, 0] }
};

/** vtk's list of cells of `size` points each. */
function cellArray(points, size) {
  const count = points.length / size;
  const cells = new Uint32Array(count * (size + 1));
  for (let i = 0; i < count; ++i) {
    cells[i * (size + 1)] = size;
    cells.set(points.subarray(i * size, (i + 1) * size), i * (size + 1) + 1);
  }
  return cells;
}

/** Triangles of three vertices each; with normals at the vertices and colours (three bytes a triangle) where given. */
function trianglesData({ points, normals }, colours) {
  const data = vtkPolyData.newInstance();
  data.getPoints().setData(Float32Array.from(points), 3);
  data.getPolys().setData(
    cellArray(
      Uint32Array.from({ length: points.length / 3 }, (_, i) => i),
      3
    )
  );
  if (normals) {
    addPointData(data, 'setNormals', 'Normals', normals, 3);
  }
  if (colours) {
    const values = Uint8Array.from({ length: points.length }, (_, i) => colours[3 * Math.floor(i / 9) + (i % 3)]);
    addPointData(data, 'setScalars', 'Colour', values, 3);
  }
  return data;
}

function addPointData(data, method, name, values, numberOfComponents) {
  data.getPointData()[method](vtkDataArray.newInstance({ name, values, numberOfComponents }));
}

/** Separate line segments, or polylines where `lines` holds vtk's cells. */
function linesData(points, lines) {
  const data = vtkPolyData.newInstance();
  data.getPoints().setData(Float32Array.from(points), 3);
  data.getLines().setData(lines);
  return data;
}

// A pixel at a triangle's rim takes its distance from the clipping plane within the triangle: else steep triangles
// leave specks beyond the plane.
const centroidDistances = ['Vertex', 'Fragment'].map((shaderType) => ({
  shaderType,
  originalValue: 'varying float clipDistances',
  replacementValue: 'centroid varying float clipDistances',
  replaceFirst: false,
  replaceAll: false
}));

function setShader(mapper, replacements) {
  mapper.setViewSpecificProperties({ OpenGL: { ShaderReplacements: [...centroidDistances, ...replacements] } });
}

/**
 * Gives a mapper its triangles (points and, where they have a density, degree and coefficients), in the colours of their
 * density, or in those given (three bytes a triangle).
 */
function setTriangles(mapper, triangles, { range, colours }) {
  const data = trianglesData(triangles, colours);
  const isByDensity = !colours;
  if (isByDensity) {
    for (const { name, values, components } of densityAttributes(triangles, range)) {
      addPointData(data, 'addArray', name, values, components);
    }
  }
  mapper.setCustomShaderAttributes(isByDensity ? densityAttributeNames(triangles.degree) : []);
  setShader(mapper, isByDensity ? densityShader(triangles.degree) : []);
  mapper.setScalarVisibility(!isByDensity);
  mapper.setColorModeToDirectScalars();
  mapper.setInputData(data);
}

function newActor(properties) {
  const mapper = vtkMapper.newInstance();
  setShader(mapper, []);
  const actor = vtkActor.newInstance();
  actor.setMapper(mapper);
  actor.getProperty().set({ interpolation: 1, ambient: 0.3, diffuse: 0.7, specular: 0, ...properties });
  return { actor, mapper };
}

/** Lines are drawn in front of the surface they lie in. */
function newLinesActor(colour) {
  const { actor, mapper } = newActor({ lighting: false, lineWidth: 2 });
  actor.getProperty().setColor(...colour);
  mapper.setResolveCoincidentTopologyToPolygonOffset();
  mapper.setRelativeCoincidentTopologyLineOffsetParameters(-3, -3);
  return { actor, mapper };
}

function newCube() {
  const cube = vtkAnnotatedCubeActor.newInstance();
  cube.setDefaultStyle({
    fontStyle: 'bold',
    fontFamily: 'system-ui, sans-serif',
    fontColor: '#20262d',
    faceColor: '#e8ebee',
    edgeThickness: 0.04,
    edgeColor: '#8a939c',
    resolution: 256,
    fontSizeScale: (resolution) => resolution / 1.7
  });
  cube.setXPlusFaceProperty({ text: 'L', faceRotation: 90 });
  cube.setXMinusFaceProperty({ text: 'R', faceRotation: -90 });
  cube.setYPlusFaceProperty({ text: 'P', faceRotation: 180 });
  cube.setYMinusFaceProperty({ text: 'A', faceRotation: 0 });
  cube.setZPlusFaceProperty({ text: 'S', faceRotation: 0 });
  cube.setZMinusFaceProperty({ text: 'I', faceRotation: 180 });
  return cube;
}

export class Scene {
  /** Draws into `container`; throws an Error where the browser has no WebGL 2. onFrame is called after each frame. */
  constructor(container, onFrame) {
    this.container = container;
    this.onFrame = onFrame;
    this.window = vtkRenderWindow.newInstance();
    this.renderer = vtkRenderer.newInstance({ background: [1, 1, 1] });
    this.window.addRenderer(this.renderer);
    this.view = vtkOpenGLRenderWindow.newInstance();
    this.canvas = this.view.getCanvas();
    // vtk.js asks for its context later and is given this one: its picture is kept for printing.
    if (!this.canvas.getContext('webgl2', { preserveDrawingBuffer: true, depth: true, alpha: true })) {
      throw new Error('This browser has no WebGL 2, which the interactive view needs.');
    }
    this.view.setContainer(container);
    this.window.addView(this.view);
    this.camera = this.renderer.getActiveCamera();
    this.camera.setParallelProjection(true);
    this.distance = 1;
    this.surfaces = new Map();
    this.contours = new Map();
    this.landmarks = [];
    this.clipPlane = vtkPlane.newInstance();
    this.isClipped = false;
    this.cut = newActor({ lighting: false });
    this.cutEdges = newLinesActor([0.1, 0.1, 0.1]);
    this.cutEdges.actor.getProperty().set({ lineWidth: 1, opacity: 0.35 });
    for (const { actor } of [this.cut, this.cutEdges]) {
      actor.setVisibility(false);
      this.renderer.addActor(actor);
    }
    this.addCube();
    this.render = oncePerFrame(() => this.renderNow());
    new ResizeObserver(() => this.resize()).observe(container);
  }

  addCube() {
    this.cubeRenderer = vtkRenderer.newInstance();
    this.window.addRenderer(this.cubeRenderer);
    this.window.setNumberOfLayers(2);
    this.cubeRenderer.setLayer(1);
    this.cubeRenderer.setInteractive(false);
    this.cubeRenderer.addActor(newCube());
    this.cubeRenderer.getActiveCamera().setParallelProjection(true);
  }

  /** Fits the canvas to its container. */
  resize() {
    const { width, height } = this.container.getBoundingClientRect();
    if (width > 0 && height > 0) {
      this.pixelRatio = Math.min(window.devicePixelRatio || 1, 2);
      this.view.setSize(Math.round(width * this.pixelRatio), Math.round(height * this.pixelRatio));
      const cube = Math.max(72, Math.min(104, 0.2 * height));
      this.cubeRenderer.setViewport(1 - cube / width, 0, 1, cube / height);
      this.renderNow();
    }
  }

  renderNow() {
    const cubeCamera = this.cubeRenderer.getActiveCamera();
    cubeCamera.setPosition(...this.direction().map((component) => 5 * component));
    cubeCamera.setFocalPoint(0, 0, 0);
    cubeCamera.setViewUp(...this.camera.getViewUp());
    cubeCamera.setParallelScale(1.05);
    this.cubeRenderer.resetCameraClippingRange();
    this.renderer.resetCameraClippingRange();
    this.window.render();
    this.onFrame();
  }

  /** Draws at once, for print. */
  setBackground(colour) {
    this.renderer.setBackground(...colour);
    this.renderNow();
  }

  /** The unit vector from the model to the camera. */
  direction() {
    return this.camera.getDirectionOfProjection().map((component) => -component);
  }

  /** Looks from one of viewsByName. */
  lookFrom(name) {
    const { direction, up } = viewsByName[name];
    this.placeCamera(this.camera.getFocalPoint(), direction, up);
  }

  placeCamera(centre, direction, up) {
    this.camera.setFocalPoint(...centre);
    this.camera.setPosition(...centre.map((component, i) => component + this.distance * direction[i]));
    this.camera.setViewUp(...up);
    this.render();
  }

  /** Fits the picture to a box [x least, x greatest, y least, …] seen along the present direction. */
  fit(bounds) {
    const centre = [0, 2, 4].map((i) => (bounds[i] + bounds[i + 1]) / 2);
    const half = [0, 2, 4].map((i) => (bounds[i + 1] - bounds[i]) / 2);
    const direction = this.direction();
    const up = this.camera.getViewUp();
    const right = [
      up[1] * direction[2] - up[2] * direction[1],
      up[2] * direction[0] - up[0] * direction[2],
      up[0] * direction[1] - up[1] * direction[0]
    ];
    const reach = (axis) => axis.reduce((sum, component, i) => sum + Math.abs(component) * half[i], 0);
    const [width, height] = this.view.getSize();
    this.distance = 4 * Math.hypot(...half);
    this.camera.setParallelScale(1.12 * Math.max(reach(up), (reach(right) * height) / width));
    this.placeCamera(centre, direction, up);
  }

  /** Turns the camera about the model, in degrees. */
  turn(right, up) {
    this.camera.azimuth(-right);
    this.camera.elevation(up);
    this.camera.orthogonalizeViewUp();
    this.render();
  }

  /** Moves the picture by canvas pixels (CSS). */
  move(right, down) {
    const mm = this.millimetresPerPixel();
    const direction = this.direction();
    const up = this.camera.getViewUp();
    const across = [
      up[1] * direction[2] - up[2] * direction[1],
      up[2] * direction[0] - up[0] * direction[2],
      up[0] * direction[1] - up[1] * direction[0]
    ];
    const shift = [0, 1, 2].map((i) => mm * (down * up[i] - right * across[i]));
    this.camera.setFocalPoint(...this.camera.getFocalPoint().map((component, i) => component + shift[i]));
    this.camera.setPosition(...this.camera.getPosition().map((component, i) => component + shift[i]));
    this.render();
  }

  /** Magnifies the picture by a factor. */
  zoom(factor) {
    this.camera.setParallelScale(this.camera.getParallelScale() / factor);
    this.render();
  }

  /** Millimetres of the model that a CSS pixel of the canvas shows. */
  millimetresPerPixel() {
    return (2 * this.camera.getParallelScale()) / this.container.getBoundingClientRect().height;
  }

  /** The position in the canvas, in CSS pixels from its upper left corner, of a point in LPS mm. */
  project(point) {
    const [width, height] = this.view.getSize();
    const matrix = this.camera.getCompositeProjectionMatrix(width / height, -1, 1);
    const row = (i) =>
      matrix[4 * i] * point[0] + matrix[4 * i + 1] * point[1] + matrix[4 * i + 2] * point[2] + matrix[4 * i + 3];
    const size = this.container.getBoundingClientRect();
    return [(0.5 + (0.5 * row(0)) / row(3)) * size.width, (0.5 - (0.5 * row(1)) / row(3)) * size.height];
  }

  /** Shows a region's surface, as surface.js makes it. colouring: see setTriangles. */
  setSurface(region, surface, colouring) {
    if (!this.surfaces.has(region)) {
      // The inner side is never seen through a cut: there the cut's own faces lie.
      const item = newActor({ backfaceCulling: true });
      this.surfaces.set(region, item);
      this.renderer.addActor(item.actor);
      this.clip(item.mapper);
    }
    setTriangles(this.surfaces.get(region).mapper, surface, colouring);
    this.render();
  }

  setRegion(region, isShown, opacity) {
    const { actor } = this.surfaces.get(region);
    actor.setVisibility(isShown && opacity > 0);
    actor.getProperty().setOpacity(opacity);
    this.render();
  }

  clip(mapper) {
    mapper.removeAllClippingPlanes();
    if (this.isClipped) {
      mapper.addClippingPlane(this.clipPlane);
    }
  }

  /** Shows a cut, as cut.js makes it, and clips away what lies where `normal` points to; none where cut is null. */
  setCut(cut, colouring, hasEdges, origin, normal) {
    const isClipped = cut !== null;
    if (isClipped) {
      setTriangles(this.cut.mapper, cut, colouring);
      const points = cut.outlines;
      const lines = cellArray(
        Uint32Array.from({ length: points.length / 3 }, (_, i) => i),
        2
      );
      this.cutEdges.mapper.setInputData(linesData(points, lines));
      this.turnClip(origin, normal);
    }
    this.cut.actor.setVisibility(isClipped);
    this.cutEdges.actor.setVisibility(isClipped && hasEdges);
    if (isClipped !== this.isClipped) {
      this.isClipped = isClipped;
      [...this.surfaces.values(), ...this.contours.values()].forEach(({ mapper }) => this.clip(mapper));
    }
    this.render();
  }

  /** Says which side of the cut is clipped away: that where `normal` points to. */
  turnClip(origin, normal) {
    this.clipPlane.setOrigin(...origin);
    this.clipPlane.setNormal(...normal.map((component) => -component));
  }

  /** Adds polylines (lines: vtk's cells) by a name. */
  addContours(name, colour, points, lines) {
    const item = newLinesActor(colour);
    item.mapper.setInputData(linesData(points, lines));
    this.contours.set(name, item);
    this.renderer.addActor(item.actor);
  }

  setContoursShown(name, isShown) {
    this.contours.get(name).actor.setVisibility(isShown);
    this.render();
  }

  /** Adds a small ball. */
  addLandmark(position, radius, colour) {
    const item = newActor({});
    const ball = vtkSphereSource.newInstance({ center: position, radius, thetaResolution: 20, phiResolution: 20 });
    item.mapper.setInputConnection(ball.getOutputPort());
    item.actor.getProperty().setColor(...colour);
    this.landmarks.push(item);
    this.renderer.addActor(item.actor);
  }

  setLandmarksShown(isShown) {
    this.landmarks.forEach(({ actor }) => actor.setVisibility(isShown));
    this.render();
  }
}
