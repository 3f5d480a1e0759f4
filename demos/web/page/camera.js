// A camera on a sphere around a point. Vectors are lists, matrices are by columns, as WebGL takes them.

export function sub(a, b) { return [a[0] - b[0], a[1] - b[1], a[2] - b[2]]; }
export function dot(a, b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
export function cross(a, b) {
  return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
}
export function scaled(a, s) { return [a[0] * s, a[1] * s, a[2] * s]; }
export function sum(a, b) { return [a[0] + b[0], a[1] + b[1], a[2] + b[2]]; }
export function unit(a) { return scaled(a, 1 / Math.hypot(...a)); }

export class Camera {
  constructor() {
    this.target = [0, -0.06, 0];
    this.distance = 1.24;
    this.azimuth = 0.785;   // [rad]
    this.elevation = 0.5;   // [rad]
    this.angle = 34 * Math.PI / 180;  // of sight, vertical
  }

  turn(dx, dy) {
    this.azimuth -= 0.008 * dx;
    this.elevation = Math.min(1.5, Math.max(-1.5, this.elevation + 0.008 * dy));
  }
  zoom(factor) { this.distance = Math.min(6, Math.max(0.15, this.distance * factor)); }

  eye() {
    const c = Math.cos(this.elevation);
    const from = [c * Math.sin(this.azimuth), Math.sin(this.elevation), c * Math.cos(this.azimuth)];
    return sum(this.target, scaled(from, this.distance));
  }
  /// Right, up and back, of length 1.
  axes() {
    const back = unit(sub(this.eye(), this.target));
    const right = unit(cross([0, 1, 0], back));
    return [right, cross(back, right), back];
  }
  /// Through a place of the picture, both coordinates −1 … 1: where it starts and its direction, of length 1.
  ray(x, y, aspect) {
    const [r, u, b] = this.axes(), t = Math.tan(this.angle / 2);
    return [this.eye(), unit(sum(sum(scaled(r, x * t * aspect), scaled(u, y * t)), scaled(b, -1)))];
  }
  view() {
    const eye = this.eye(), [r, u, b] = this.axes();
    return [r[0], u[0], b[0], 0, r[1], u[1], b[1], 0, r[2], u[2], b[2], 0, -dot(r, eye), -dot(u, eye), -dot(b, eye), 1];
  }
  projection(aspect) {
    const f = 1 / Math.tan(this.angle / 2), near = 0.02, far = 12;
    return [f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (near + far) / (near - far), -1, 0, 0, 2 * near * far / (near - far), 0];
  }
}
