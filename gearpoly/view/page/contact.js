// First touch of two faces, exactly as polygons: about the driving axis a rotation only shifts polar angles, so two
// polylines first touch by the least difference of their polar angles at equal radius, and that stands at a vertex of
// one of them. It is the page's own kernel, an implementation beside the one that made the simulated curves; the page
// compares both when it opens.
//
// For the coast flank everything is mirrored in the line of centres (s = -1), as in the simulation.

export const best = { sine: 0, cosine: 1, mine: 0, mate: 0, turning: true, x: 0, y: 0 };

// Weighs one vertex (x, y) against the edge A-B of the other face at the vertex's radius; side +1: the vertex turns.
function weigh(x, y, q, place, ax, ay, a2, bx, by, b2, placeA, placeB, side) {
  const dx = bx - ax;
  const dy = by - ay;
  const half = ax * dx + ay * dy;
  const rest = q - a2;
  // |A + t D|^2 = q without cancellation.
  const root = Math.sqrt(Math.max(half * half + (dx * dx + dy * dy) * rest, 0));
  const below = b2 >= a2 ? half + root : half - root;
  const t = below !== 0 ? rest / below : 0;
  const gx = ax + t * dx - x;
  const gy = ay + t * dy - y;
  const cross = side * (x * gy - y * gx);
  const dot = q + x * gx + y * gy;
  if (dot > 0 && cross < best.sine * q) {
    best.sine = cross / q;
    best.cosine = dot / q;
    const onLine = placeA + t * (placeB - placeA);
    best.turning = side > 0;
    best.mine = best.turning ? place : onLine;
    best.mate = best.turning ? onLine : place;
    best.x = best.turning ? x : x + gx;
    best.y = best.turning ? y : y + gy;
  }
  return Math.atan2(cross, dot);
}

// Fills `best` with the first touch of turning face i of A on fixed face j of B; false where no radius is common.
// `at`: turning axis in the fixed frame, then cosine and sine from that frame into the turning one. `each`, where
// given, hears the radius and the rotation at every stride-th vertex of B.
export function closing(A, i, B, j, s, at, each, stride) {
  const [ox, oy, wx, wy] = at;
  const a = A.xy;
  const b = B.xy;
  const { r2 } = A;
  const base = i * A.n;
  const first = base + A.first[i];
  const last = base + A.n - 1;
  const high = r2[last];
  best.sine = 1;
  let p = first - 1; // the last turning vertex within the fixed vertex's radius
  let px = 0, py = 0, pq = 0, pp = 0;
  for (let k = B.n - 1; k >= 0; k--) {
    const at2 = 2 * (j * B.n + k);
    const u = b[at2] - ox;
    const v = s * b[at2 + 1] - oy;
    const x = wx * u - wy * v;
    const y = wx * v + wy * u;
    const q = x * x + y * y;
    while (p < last && r2[p + 1] <= q) p++;
    while (p >= first && r2[p] > q) p--;
    if (p >= first && q <= high) {
      const e = p === last ? p - 1 : p;
      const turn = weigh(
        x, y, q, k, a[2 * e], s * a[2 * e + 1], r2[e], a[2 * e + 2], s * a[2 * e + 3], r2[e + 1],
        e - base, e + 1 - base, -1,
      );
      if (each && k % stride === 0) each(Math.sqrt(q), turn);
    }
    if (k < B.n - 1) {
      for (let c = Math.min(p, pp) + 1; c <= Math.max(p, pp); c++) {
        if (!each) weigh(a[2 * c], s * a[2 * c + 1], r2[c], c - base, x, y, q, px, py, pq, k, k + 1, 1);
      }
      if (q > high && pq > high && q > pq) break;
    }
    px = x; py = y; pq = q; pp = p;
  }
  return best.sine < 1;
}

// Unit tangent root to tip of the smooth face behind the polyline at vertex number `place`, by circles through three
// vertices.
function tangent(faces, tooth, place, s) {
  const { xy, n } = faces;
  const base = 2 * tooth * n;
  const edge = (k) => {
    const dx = xy[base + 2 * k + 2] - xy[base + 2 * k];
    const dy = s * (xy[base + 2 * k + 3] - xy[base + 2 * k + 1]);
    const length = Math.hypot(dx, dy);
    return [dx / length, dy / length, length];
  };
  const mixed = (e, f, share) => {
    const x = e[0] * (1 - share) + f[0] * share;
    const y = e[1] * (1 - share) + f[1] * share;
    const length = Math.hypot(x, y);
    return [x / length, y / length];
  };
  const vertex = (k) => {
    if (k === 0) return mixed(edge(0), edge(1), -0.5);
    if (k === n - 1) return mixed(edge(n - 2), edge(n - 3), -0.5);
    const [e, f] = [edge(k - 1), edge(k)];
    return mixed(e, f, e[2] / (e[2] + f[2]));
  };
  const low = Math.min(Math.floor(place), n - 2);
  return mixed(vertex(low), vertex(low + 1), place - low);
}

// Whether flank or a tip corner touches, and the unit normal in the turning frame: `spin` is the angle from the fixed
// frame into it.
export function describeTouch(A, i, B, j, s, touch, spin) {
  const mine = tangent(A, i, touch.mine, s);
  const raw = tangent(B, j, touch.mate, s);
  const [c, d] = [Math.cos(spin), Math.sin(spin)];
  const mate = [c * raw[0] - d * raw[1], d * raw[0] + c * raw[1]];
  const normal = touch.turning ? [mate[1], -mate[0]] : [-mine[1], mine[0]];
  // angle(-mine / mate): how far the mate's tangent has turned past that of the corner.
  const past = Math.atan2(-(mine[1] * mate[0] - mine[0] * mate[1]), -(mine[0] * mate[0] + mine[1] * mate[1]));
  let feature = "flank";
  if (touch.turning && touch.mine > A.n - 1.5 && past > 0) feature = "driving tip corner";
  if (!touch.turning && touch.mate > B.n - 1.5 && past < 0) feature = "driven tip corner";
  return { normal, feature };
}
