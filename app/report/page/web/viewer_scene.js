// What is drawn of one attempt: tooth, neighbours and burr at a moment, and ghosts.

const bytesOf = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));

// Colours of the scales: from below to above, sRGB. The goal's stays apart to those who do not tell
// red from green; the others rise in lightness all the way, so that they read in grey.
const kAroundZero = ['#12408f', '#6a9fd8', '#f4f3ee', '#ee9440', '#8f3208'];
const kRising = ['#432a6b', '#33658a', '#2a9d7c', '#8ccb4f', '#fbe44a'];
const kNothing = '#b9bbb8';

// One scale for all attempts and all pages; only who looks at it sets another.
const kColourings = {
  tissue: {title: 'tissue'},
  goal: {title: 'error against the plan', ramp: kAroundZero, ranges: [0.25, 0.5, 1], range: 0.5,
         around: true, unit: 'mm', low: 'still missing', high: 'cut beyond'},
  depth: {title: 'depth', ramp: kRising, ranges: [2, 4, 8], range: 4, unit: 'mm'},
  order: {title: 'order of cutting', ramp: kRising, ranges: [100], range: 100, unit: '%',
          low: 'first', high: 'last'},
};

const vectorOf = hex => new THREE.Vector3(
    ...[1, 3, 5].map(at => parseInt(hex.slice(at, at + 2), 16) / 255));

const kVertexShader = `
varying vec3 vAt, vNormal, vSeen, vSeenNormal;
void main() {
  vAt = position;
  vNormal = normal;
  vec4 seen = modelViewMatrix * vec4(position, 1.0);
  vSeen = seen.xyz;
  vSeenNormal = normalMatrix * normal;
  gl_Position = projectionMatrix * seen;
}`;

const kToothShader = `
precision highp sampler3D;
uniform int colouring;
uniform bool boxed, hasGoal;
uniform vec3 tint, low, samples, nothing;
uniform vec3 ramp[5];
uniform float step3, goalStep, depthStep, range;
uniform sampler3D tissueGoal, cutDepth;
varying vec3 vAt, vNormal, vSeen, vSeenNormal;

vec4 lookUp(sampler3D field, vec3 at) {
  return texture(field, ((at - low) / step3 + 0.5) / samples);
}
vec3 scale(float part) {
  float at = clamp(part, 0.0, 1.0) * 4.0;
  for (int k = 0; k < 4; ++k) {
    if (at <= float(k + 1)) return mix(ramp[k], ramp[k + 1], at - float(k));
  }
  return ramp[4];
}
void main() {
  vec3 n = normalize(vNormal);
  vec3 colour = colouring == 0 ? tint : nothing;
  float matt = colouring == 0 ? 0.0 : 1.0;
  if (boxed) {
    vec4 under = lookUp(tissueGoal, vAt - 0.6 * step3 * n);
    vec4 here = lookUp(tissueGoal, vAt);
    vec4 over = lookUp(cutDepth, vAt + 0.75 * step3 * n);
    bool cut = over.g > 0.35;
    if (colouring == 0) {
      colour = under.rgb;
    } else if (colouring == 1 && hasGoal) {
      float error = (here.a * 255.0 - 128.0) * goalStep;
      if (error < 0.0 || cut) colour = scale(0.5 + 0.5 * error / range);
    } else if (colouring == 2 && cut) {
      colour = scale(lookUp(cutDepth, vAt).b * 255.0 * depthStep / range);
    } else if (colouring == 3 && cut) {
      colour = scale(over.r / over.g);
    }
  }
  vec3 seen = normalize(vSeenNormal);
  vec3 eye = normalize(-vSeen);
  if (dot(seen, eye) < 0.0) seen = -seen;
  float light = 0.42 + 0.30 * max(dot(seen, normalize(vec3(-0.5, 0.7, 0.6))), 0.0)
              + 0.34 * max(dot(seen, eye), 0.0);
  float gloss = pow(max(dot(reflect(-eye, seen), normalize(vec3(-0.5, 0.7, 0.6))), 0.0), 24.0);
  light = mix(light, 0.55 + 0.45 * light, matt);
  gl_FragColor = vec4(colour * light + 0.12 * gloss * (1.0 - matt), 1.0);
}`;

const kGhostShader = `
uniform vec3 tint;
uniform float thin;
varying vec3 vAt, vNormal, vSeen, vSeenNormal;
void main() {
  float facing = abs(dot(normalize(vSeenNormal), normalize(-vSeen)));
  gl_FragColor = vec4(tint, thin + 0.75 * pow(1.0 - facing, 2.0));
}`;

// Positions are whole steps from `low`, mm.
function geometryOf(mesh, low, step) {
  const steps = new Uint16Array(bytesOf(mesh.positions).buffer);
  const positions = new Float32Array(steps.length);
  for (let i = 0; i < steps.length; ++i) positions[i] = low[i % 3] + step * steps[i];
  const indices = bytesOf(mesh.indices).buffer;
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new THREE.BufferAttribute(
      new Int8Array(bytesOf(mesh.normals).buffer), 3, true));
  geometry.setIndex(new THREE.BufferAttribute(
      mesh.index_bytes === 2 ? new Uint16Array(indices) : new Uint32Array(indices), 1));
  return geometry;
}

// `bytes`: one, three or four a sample, x fastest.
function fieldTexture(bytes, parts, [nx, ny, nz]) {
  const rgba = new Uint8Array(4 * nx * ny * nz);
  for (let n = 0; n < nx * ny * nz; ++n) {
    for (let k = 0; k < parts; ++k) rgba[4 * n + k] = bytes[parts * n + k];
  }
  const texture = new THREE.DataTexture3D(rgba, nx, ny, nz);
  texture.minFilter = texture.magFilter = THREE.LinearFilter;
  texture.wrapR = THREE.ClampToEdgeWrapping;
  texture.unpackAlignment = 4;
  return texture;
}

function ghostMaterial(colour, thin) {
  return new THREE.ShaderMaterial({
    uniforms: {tint: {value: vectorOf(colour)}, thin: {value: thin}},
    vertexShader: kVertexShader, fragmentShader: kGhostShader,
    transparent: true, depthTest: false, depthWrite: false,
  });
}

class AttemptScene {
  // `shared`: uniforms that all attempts have: colouring, range, ramp.
  constructor(attempt, shared) {
    this.attempt = attempt;
    this.shared = shared;
    this.scene = new THREE.Scene();
    this.bounds = new THREE.Box3();
    this.moving = [];  // of each body: {meshes by moment}
    this.ghosts = {plan: [], before: []};
    this.moment = -1;
    for (const body of attempt.bodies) this.addBody(body);
    if (attempt.plan) {
      this.addGhost('plan', geometryOf(attempt.plan, attempt.plan.low, attempt.plan.step), null,
                    ghostMaterial('#2f6fd6', 0.16));
    }
    if (attempt.burr) this.addBurr(attempt.burr);
    this.show(attempt.moments.length - 1);
  }

  toothMaterial(tint, fields, textures) {
    const own = {
      tint: {value: tint}, boxed: {value: !!fields}, nothing: {value: vectorOf(kNothing)},
      hasGoal: {value: !!fields && fields.has_goal},
      low: {value: new THREE.Vector3(...(fields ? fields.low : [0, 0, 0]))},
      samples: {value: new THREE.Vector3(...(fields ? fields.samples : [1, 1, 1]))},
      step3: {value: fields ? fields.step : 1},
      goalStep: {value: fields ? fields.goal_step : 0},
      depthStep: {value: fields ? fields.depth_step : 0},
      tissueGoal: {value: textures[0]}, cutDepth: {value: textures[1]},
    };
    return new THREE.ShaderMaterial({
      uniforms: Object.assign(own, this.shared), side: THREE.DoubleSide,
      vertexShader: kVertexShader, fragmentShader: kToothShader,
    });
  }

  add(geometry, material, matrix) {
    const mesh = new THREE.Mesh(geometry, material);
    if (matrix) {
      mesh.matrix.fromArray(matrix);
      mesh.matrixAutoUpdate = false;
    }
    this.scene.add(mesh);
    return mesh;
  }

  addBody(body) {
    const none = fieldTexture(new Uint8Array(4), 4, [1, 1, 1]);
    const first = this.scene.children.length;
    for (const part of body.still) {
      const tint = new THREE.Vector3(...part.colour.map(c => c / 255));
      this.add(geometryOf(part, body.low, body.step), this.toothMaterial(tint, null, [none, none]),
               body.matrix);
    }
    if (body.fields) {
      const f = body.fields;
      const textures = [fieldTexture(bytesOf(f.tissue_goal), 4, f.samples),
                        fieldTexture(bytesOf(f.cut_depth), 3, f.samples)];
      const material = this.toothMaterial(new THREE.Vector3(), f, textures);
      const meshes = body.moving.map(part => {
        const mesh = this.add(geometryOf(part, body.low, body.step), material, body.matrix);
        mesh.visible = false;
        return mesh;
      });
      this.moving.push({meshes, shown: body.shown});
      this.addGhost('before', meshes[0].geometry, body.matrix, ghostMaterial('#f8fafc', 0.12));
    }
    if (this.moving.length > 1 || this.bounds.isEmpty()) {
      // Neighbours are seen beside it; the view is of the workpiece.
      if (!this.bounds.isEmpty()) return;
      for (const mesh of this.scene.children.slice(first)) this.bounds.expandByObject(mesh);
    }
  }

  addGhost(name, geometry, matrix, material) {
    const mesh = this.add(geometry, material, matrix);
    mesh.renderOrder = 2;
    mesh.visible = false;
    this.ghosts[name].push(mesh);
  }

  addBurr(burr) {
    this.burr = this.add(geometryOf(burr, burr.low, burr.step),
                         this.toothMaterial(vectorOf('#8e959d'), null, this.noTextures()), null);
    this.burr.material.uniforms = Object.assign({}, this.burr.material.uniforms,
                                                {colouring: {value: 0}});
    this.burr.visible = false;
    this.poses = new Float32Array(bytesOf(burr.poses).buffer);
  }

  noTextures() {
    const none = fieldTexture(new Uint8Array(4), 4, [1, 1, 1]);
    return [none, none];
  }

  show(moment) {
    this.moment = moment;
    for (const {meshes, shown} of this.moving) {
      meshes.forEach((mesh, n) => { mesh.visible = n === shown[moment]; });
    }
    if (this.poses) this.placeBurr(this.attempt.moments[moment].time_s);
  }

  placeBurr(time) {
    const p = this.poses;
    let at = 0;
    while (at + 8 < p.length && p[at + 8] <= time + 1e-6) at += 8;
    this.burr.position.set(p[at + 1], p[at + 2], p[at + 3]);
    this.burr.quaternion.set(p[at + 4], p[at + 5], p[at + 6], p[at + 7]);
  }

  // The last moment with no more than a share of the edits made, or by a time.
  momentOfShare(share) {
    return this.lastMoment(m => m.share <= share + 1e-9);
  }
  momentOfTime(time) {
    return this.lastMoment(m => m.time_s <= time + 1e-9);
  }
  lastMoment(holds) {
    const moments = this.attempt.moments;
    for (let n = moments.length - 1; n > 0; --n) if (holds(moments[n])) return n;
    return 0;
  }
}
