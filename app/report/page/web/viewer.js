// The turnable view of one attempt, or of several side by side in one camera and one scale.
// `window.sulcusView` is what a script may drive; slider, pins and buttons call the same.
class Viewer {
  constructor(root, attempts) {
    this.root = root;
    this.find = name => root.querySelector(name);
    this.canvas = this.find('canvas');
    const context = this.canvas.getContext('webgl2', {antialias: true});
    if (!context) throw new Error('This browser draws no WebGL 2, which the view needs.');
    this.renderer = new THREE.WebGLRenderer({canvas: this.canvas, context});
    this.renderer.autoClear = false;
    this.shared = {colouring: {value: 0}, range: {value: 1},
                   ramp: {value: kRising.map(vectorOf)}};
    this.scenes = attempts.map(attempt => new AttemptScene(attempt, this.shared));
    this.camera = new THREE.PerspectiveCamera(28, 1, 0.1, 100);
    this.turning = new TurningCamera(this.camera, () => this.ask());
    this.turning.listen(this.canvas, () => this.views());
    this.listeners = [];
    this.pins = [];
    this.chosen = -1;
    this.makeOverlay();
    this.makePanel();
    this.setColouring(attempts.some(a => a.plan) ? 'goal' : 'tissue');
    this.whole();
    this.steps = attempts.length === 1 ? attempts[0].moments.length - 1 : 32;
    this.slider = this.find('.slide input');
    this.slider.max = this.steps;
    this.slider.addEventListener('input', () => this.setStep(Number(this.slider.value)));
    this.find('.slide .start').onclick = () => this.setStep(0);
    this.find('.slide .end').onclick = () => this.setStep(this.steps);
    this.find('.slide .play').onclick = () => this.play();
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    this.setStep(this.steps);
    this.draw();
  }

  // --- what is seen ---

  views() {
    const width = this.canvas.clientWidth / this.scenes.length;
    return this.scenes.map((_, n) => ({x: n * width, width, height: this.canvas.clientHeight}));
  }

  // The crown and what was cut, whatever the roots.
  whole() {
    const bounds = this.scenes[0].bounds;
    const size = bounds.getSize(new THREE.Vector3());
    const wide = Math.max(size.x, size.y);
    bounds.getCenter(this.turning.target);
    if (size.z > 1.2 * wide) this.turning.target.z = bounds.max.z - 0.55 * wide;
    this.turning.distance = 2.9 * Math.max(wide, Math.min(size.z, 1.1 * wide));
    const view = this.views()[0];
    if (view.width < view.height) this.turning.distance *= view.height / Math.max(1, view.width);
    this.turning.lookFrom(-70, 58);
  }

  ask() {
    if (this.asked) return;
    this.asked = true;
    requestAnimationFrame(() => this.draw());
  }

  draw() {
    this.asked = false;
    const {clientWidth, clientHeight} = this.canvas;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setPixelRatio(Math.min(2, window.devicePixelRatio || 1));
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.renderer.setScissorTest(true);
    this.renderer.setClearColor(0xdfe4ea, 1);
    this.views().forEach((view, n) => {
      this.turning.apply(view.width / view.height);
      this.renderer.setViewport(view.x, 0, view.width, view.height);
      this.renderer.setScissor(view.x, 0, view.width, view.height);
      this.renderer.clear();
      this.renderer.render(this.scenes[n].scene, this.camera);
      this.placeOverlay(n, view);
    });
    if (!this.drawnMs) this.drawnMs = performance.now();
  }

  // Pixels as they are drawn now: bytes RGBA from the lower left, and their size.
  pixels() {
    this.draw();
    const gl = this.renderer.getContext();
    const [width, height] = [gl.drawingBufferWidth, gl.drawingBufferHeight];
    const rgba = new Uint8Array(4 * width * height);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, rgba);
    return {width, height, rgba};
  }

  // --- time ---

  setStep(step) {
    this.slider.value = step;
    this.scenes.forEach(scene => scene.show(
        this.scenes.length === 1 ? step : scene.momentOfShare(step / this.steps)));
    this.choose(-1);
    this.tell();
  }
  setTime(seconds) {
    if (this.scenes.length === 1) return this.setStep(this.scenes[0].momentOfTime(seconds));
    this.scenes.forEach(scene => scene.show(scene.momentOfTime(seconds)));
    this.tell();
  }
  play() {
    if (this.steps === 0) return;  // there is but one moment
    if (this.playing) {
      clearInterval(this.playing);
      this.playing = 0;
    } else {
      if (Number(this.slider.value) === this.steps) this.setStep(0);
      this.playing = setInterval(() => {
        this.setStep(Number(this.slider.value) + 1);
        if (Number(this.slider.value) === this.steps) this.play();
      }, 200);
    }
    this.find('.slide .play').textContent = this.playing ? 'Stop' : 'Play';
  }
  tell() {
    const texts = this.scenes.map(({attempt, moment}) => {
      const m = attempt.moments[moment];
      return `${m.time_s.toFixed(2)} s of ${attempt.end_s.toFixed(2)} s, ` +
          `${m.removed_mm3.toFixed(2)} mm³ cut`;
    });
    this.captions.forEach((caption, n) => { caption.textContent = texts[n]; });
    this.find('.slide output').textContent = this.scenes.length === 1
        ? texts[0] : `${Math.round(100 * this.slider.value / this.steps)} % of each attempt's cutting`;
    this.listeners.forEach(listen => listen(
        this.scenes.map(({attempt, moment}) => attempt.moments[moment].time_s)));
    this.ask();
  }

  // --- pins ---

  // To the moment at which what a pin marks came about, and to its place.
  jump(number) {
    const pin = this.pins[number];
    const scene = this.scenes[pin.attempt];
    if (this.scenes.length === 1) {
      this.setStep(pin.moment);
    } else {
      scene.show(pin.moment);
      this.tell();
    }
    if (pin.at) {
      this.turning.target.set(...pin.at);
      this.turning.elevation = Math.max(this.turning.elevation, 58);  // into what was cut
    }
    this.choose(number);
    this.ask();
  }
  choose(number) {
    this.chosen = number;
    this.pins.forEach((pin, n) => {
      if (pin.mark) pin.mark.classList.toggle('chosen', n === number);
      pin.row.classList.toggle('on', n === number);
    });
  }

  makeOverlay() {
    const overlay = this.find('.overlay');
    const add = (tag, kind, text) => {
      const element = document.createElement(tag);
      element.className = kind;
      element.textContent = text;
      overlay.append(element);
      return element;
    };
    this.captions = [];
    this.letters = this.scenes.map(({attempt}, n) => {
      const several = this.scenes.length > 1;
      const mark = attempt.mark === null ? '' : `: ${Math.round(attempt.mark)} of 100`;
      const caption = add('div', 'caption', several ? `Attempt ${n + 1}${mark}` : '');
      const now = document.createElement('span');
      now.className = 'now';
      caption.append(now);
      caption.hidden = !several;
      caption.style.left = `calc(${100 * n / this.scenes.length}% + 12px)`;
      this.captions.push(now);
      return ['M', 'L', 'D', 'B'].map(letter => add('div', 'side-letter', letter));
    });
    const list = this.find('.pins');
    this.scenes.forEach(({attempt}, n) => attempt.pins.forEach(pin => {
      const number = this.pins.length;
      const mark = pin.at ? add('button', 'pin', '') : null;
      if (mark) {
        const digit = document.createElement('span');
        digit.textContent = number + 1;
        mark.append(digit);
        mark.title = `${pin.title}: ${pin.text}`;
        mark.onclick = () => this.jump(number);
      }
      const row = document.createElement('button');
      const name = document.createElement('b');
      name.textContent = `${number + 1} ${pin.title}`;
      const more = document.createElement('small');
      const place = this.scenes.length > 1 ? `Attempt ${n + 1}. ` : '';
      more.textContent = place + pin.text + (pin.time_s === null ? '' : `; at ${pin.time_s.toFixed(2)} s`);
      row.append(name, more);
      row.onclick = () => this.jump(number);
      const item = document.createElement('li');
      item.append(row);
      list.append(item);
      this.pins.push(Object.assign({}, pin, {attempt: n, mark, row}));
    }));
    this.find('.faults').hidden = this.pins.length === 0;
  }

  placeOverlay(n, view) {
    const place = (element, at) => {
      const p = at.clone().project(this.camera);
      const inside = Math.abs(p.x) < 1 && Math.abs(p.y) < 1 && p.z < 1;
      element.hidden = !inside;
      element.style.left = `${view.x + (p.x + 1) / 2 * view.width}px`;
      element.style.top = `${(1 - p.y) / 2 * view.height}px`;
    };
    const {bounds} = this.scenes[n];
    const middle = bounds.getCenter(new THREE.Vector3());
    const half = bounds.getSize(new THREE.Vector3()).multiplyScalar(0.5);
    middle.z = bounds.max.z - 0.35 * Math.min(half.x, half.y);
    [[1, 0], [0, 1], [-1, 0], [0, -1]].forEach(([x, y], k) => place(
        this.letters[n][k],
        new THREE.Vector3(middle.x + 1.12 * half.x * x, middle.y + 1.12 * half.y * y, middle.z)));
    for (const pin of this.pins) {
      if (pin.attempt === n && pin.mark) place(pin.mark, new THREE.Vector3(...pin.at));
    }
  }

  // --- colours ---

  setColouring(name) {
    this.colouring = name;
    const kind = kColourings[name];
    this.find('.colour').value = name;
    this.shared.colouring.value = Object.keys(kColourings).indexOf(name);
    if (kind.ramp) this.shared.ramp.value = kind.ramp.map(vectorOf);
    const ranges = this.find('.range');
    ranges.hidden = !kind.ranges || kind.ranges.length < 2;
    ranges.querySelector('select').replaceChildren(...(kind.ranges || []).map(
        r => new Option(`${kind.around ? '±' : '0 to '}${r} ${kind.unit}`, r)));
    this.setRange(kind.range || 1);
  }
  setRange(range) {
    this.shared.range.value = range;
    this.find('.range select').value = range;
    this.showLegend(kColourings[this.colouring], range);
    this.ask();
  }
  showLegend(kind, range) {
    const legend = this.find('.legend');
    legend.replaceChildren();
    const swatch = (colour, name) => {
      const row = document.createElement('div');
      row.className = 'swatch';
      const box = document.createElement('i');
      box.style.background = colour;
      row.append(box, name);
      legend.append(row);
    };
    if (!kind.ramp) {
      for (const {name, colour} of this.scenes[0].attempt.tissues) swatch(`rgb(${colour})`, name);
      return;
    }
    const bar = document.createElement('div');
    bar.className = 'bar';
    bar.style.background = `linear-gradient(to right, ${kind.ramp})`;
    const line = words => {
      const ticks = document.createElement('div');
      ticks.className = 'ticks';
      ticks.append(...words.map(word => {
        const span = document.createElement('span');
        span.textContent = word;
        return span;
      }));
      return ticks;
    };
    const parts = kind.around ? [-1, -0.5, 0, 0.5, 1] : [0, 0.5, 1];
    legend.append(bar, line(parts.map(
        p => `${+(p * range).toFixed(3)}`.replace('-', '−') + (p === 1 ? ' ' + kind.unit : ''))));
    if (kind.low) legend.append(line([kind.low, kind.high]));
    swatch(kNothing, kind.around ? 'not in the plan, not cut' : 'not cut');
  }

  // A ghost, or the burr: 'plan', 'before', 'burr'.
  setShown(name, shown) {
    for (const scene of this.scenes) {
      const meshes = name === 'burr' ? [scene.burr].filter(Boolean) : scene.ghosts[name];
      for (const mesh of meshes) mesh.visible = shown;
    }
    this.find(`.${name} input`).checked = shown;
    this.ask();
  }

  makePanel() {
    const planned = this.scenes.some(s => s.attempt.plan);
    const colour = this.find('.colour');
    for (const [name, {title}] of Object.entries(kColourings)) {
      if (name !== 'goal' || planned) colour.append(new Option(title, name));
    }
    colour.onchange = () => this.setColouring(colour.value);
    const range = this.find('.range select');
    range.onchange = () => this.setRange(Number(range.value));
    this.find('.plan').hidden = !planned;
    for (const name of ['plan', 'before', 'burr']) {
      const box = this.find(`.${name} input`);
      box.onchange = () => this.setShown(name, box.checked);
    }
    const from = this.find('.from');
    for (const [name, azimuth, elevation] of [
      ['Occlusal', -90, 90], ['Buccal', -90, 10], ['Lingual', 90, 10], ['Mesial', 0, 10],
      ['Distal', 180, 10]]) {
      const button = document.createElement('button');
      button.textContent = name;
      button.onclick = () => this.turning.lookFrom(azimuth, elevation);
      from.append(button);
    }
    const whole = document.createElement('button');
    whole.textContent = 'Whole';
    whole.onclick = () => this.whole();
    from.append(whole);
  }
}
