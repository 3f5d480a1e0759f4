// What the mouse points at. Vectors are lists.
import {cross, dot, scaled, sub, sum, unit} from './camera.js';

/// How far along the ray the triangle is hit, from either side; Infinity where it is not.
function hit_on_triangle([eye, along], a, b, c) {
  const u = sub(b, a), v = sub(c, a), p = cross(along, v), det = dot(u, p);
  if (det === 0) return Infinity;
  const from = sub(eye, a), s = dot(from, p) / det, q = cross(from, u), t = dot(along, q) / det;
  const distance = dot(v, q) / det;
  return s >= 0 && t >= 0 && s + t <= 1 && distance > 0 ? distance : Infinity;
}

/// The point of the sheet that a ray hits first; null where it hits none.
export function hit_on_sheet(ray, nodes, triangles) {
  const node = (k) => [nodes[3 * k], nodes[3 * k + 1], nodes[3 * k + 2]];
  let nearest = Infinity;
  for (let t = 0; t < triangles.length; t += 3)
    nearest = Math.min(nearest, hit_on_triangle(ray, ...[0, 1, 2].map((k) => node(triangles[t + k]))));
  return nearest < Infinity ? sum(ray[0], scaled(ray[1], nearest)) : null;
}

/// Where a ray hits the plane through `point` across `normal`; null where it does not.
export function hit_on_plane([eye, along], point, normal) {
  const speed = dot(along, normal), distance = dot(sub(point, eye), normal) / speed;
  return distance > 0 && Number.isFinite(distance) ? sum(eye, scaled(along, distance)) : null;
}

/// `direction`, of length 1, turned by `angle` [rad] towards `goal`; as it is where it points there.
export function turned_towards(direction, goal, angle) {
  const across = sub(goal, scaled(direction, dot(goal, direction)));
  if (!(Math.hypot(...across) > 1e-6)) return direction;
  return sum(scaled(direction, Math.cos(angle)), scaled(unit(across), Math.sin(angle)));
}
