// How the pointer turns, moves and nears a camera. Angles in degrees, as `--camera` has them: from
// mesial (+x) towards lingual (+y), and up; at 90 the picture is turned as seen from buccal.
class TurningCamera {
  constructor(camera, changed) {
    this.camera = camera;
    this.changed = changed;
    this.target = new THREE.Vector3();
    this.azimuth = -70;
    this.elevation = 58;
    this.distance = 10;
  }

  axes() {
    const a = this.azimuth * Math.PI / 180, e = this.elevation * Math.PI / 180;
    const out = new THREE.Vector3(Math.cos(a) * Math.cos(e), Math.sin(a) * Math.cos(e), Math.sin(e));
    const right = new THREE.Vector3(-Math.sin(a), Math.cos(a), 0);
    return {out, right, up: new THREE.Vector3().crossVectors(out, right)};
  }

  apply(aspect) {
    const {out, right, up} = this.axes();
    const camera = this.camera;
    camera.position.copy(this.target).addScaledVector(out, this.distance);
    camera.quaternion.setFromRotationMatrix(new THREE.Matrix4().makeBasis(right, up, out));
    camera.near = this.distance / 50;
    camera.far = this.distance * 10;
    camera.aspect = aspect;
    camera.updateProjectionMatrix();
    camera.updateMatrixWorld();
  }

  lookFrom(azimuth, elevation) {
    this.azimuth = azimuth;
    this.elevation = elevation;
    this.changed();
  }

  turn(dx, dy) {
    this.azimuth -= 0.4 * dx;
    this.elevation = Math.max(-90, Math.min(90, this.elevation + 0.4 * dy));
    this.changed();
  }

  // mm of the target's plane to a pixel.
  pixel(height) {
    return 2 * this.distance * Math.tan(this.camera.fov * Math.PI / 360) / height;
  }

  move(dx, dy, height) {
    const {right, up} = this.axes();
    this.target.addScaledVector(right, -dx * this.pixel(height));
    this.target.addScaledVector(up, dy * this.pixel(height));
    this.changed();
  }

  // What lies under the pointer, `dx`, `dy` pixels from the middle, stays there.
  near(factor, dx, dy, height) {
    const distance = Math.max(0.5, Math.min(200, this.distance * factor));
    const moved = 1 - distance / this.distance;
    this.move(-dx * moved, -dy * moved, height);
    this.distance = distance;
    this.changed();
  }

  // `views()`: the rectangles, in pixels of the element, that show this camera's picture.
  listen(element, views) {
    const fingers = new Map();
    let panning = false;
    element.addEventListener('contextmenu', e => e.preventDefault());
    element.addEventListener('pointerdown', e => {
      fingers.set(e.pointerId, e);
      panning = e.button !== 0 || e.shiftKey;
      element.setPointerCapture(e.pointerId);
    });
    const up = e => fingers.delete(e.pointerId);
    element.addEventListener('pointerup', up);
    element.addEventListener('pointercancel', up);
    element.addEventListener('pointermove', e => {
      const before = fingers.get(e.pointerId);
      if (!before) return;
      const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
      const height = element.clientHeight;
      if (fingers.size === 2) {
        const other = [...fingers.values()].find(f => f.pointerId !== e.pointerId);
        const apart = f => Math.hypot(f.clientX - other.clientX, f.clientY - other.clientY);
        this.near(apart(before) / Math.max(1, apart(e)), 0, 0, height);
        this.move(dx / 2, dy / 2, height);
      } else if (panning) {
        this.move(dx, dy, height);
      } else {
        this.turn(dx, dy);
      }
      fingers.set(e.pointerId, e);
    });
    element.addEventListener('wheel', e => {
      e.preventDefault();
      const view = views().find(v => e.offsetX >= v.x && e.offsetX < v.x + v.width);
      if (!view) return;
      const dx = e.offsetX - (view.x + view.width / 2), dy = e.offsetY - view.height / 2;
      this.near(Math.exp(Math.sign(e.deltaY) * 0.12), dx, dy, view.height);
    }, {passive: false});
  }
}
