// Programs of the graphics processor. All draw in colours as they show, without lighting.
//
// surfaces: a column for each surface field of the points (0: none, 1: moving, 2 + index):
//   row 0  normal, and distance; of a cylinder its side (+1, -1) in place of the distance
//   row 1  of a cylinder its axis (x, y), its radius and 1; else zeros
//   row 2  colour, and a number: how much of it shows whatever the points are coloured by, below
//          1; plus 2 where the surface is hidden, since it is seen from behind; plus 4 for a
//          cylinder, of which each place has to be looked at

const VISIBILITY = `
precision highp float;
precision highp sampler2D;
uniform mat4 viewMatrix;
uniform mat4 projectionMatrix;
uniform vec3 eye;
uniform vec2 heights;     // shown between these, m
uniform float hide_backs; // 1: not what is seen from behind
uniform sampler2D surfaces;

vec4 surface_row(float field, int row) { return texelFetch(surfaces, ivec2(int(field), row), 0); }

// own: row 2 of the surface.
bool is_hidden(vec4 own, float field, vec3 p) {
  if (own.a < 2.0 || hide_backs == 0.0) return false;
  if (own.a < 4.0) return true;
  vec2 away = p.xy - surface_row(field, 1).xy;
  return surface_row(field, 0).w * dot(away, eye.xy - p.xy) < 0.0;
}
`;

export const POINT_VERTEX = `
${VISIBILITY}
uniform vec3 origin;
uniform float step_m;
uniform vec2 times;        // shown between these, in steps of time
uniform int coloured_by;   // 0 surface, 1 height, 2 time, 3 scanner, 4 residual
uniform vec2 ramp_ends;    // values of the ramp's two ends
uniform sampler2D ramp;
uniform sampler2D scanners;
uniform float point_m;     // size of a point
uniform float pixels;      // that 1 m takes at a distance of 1 m
uniform float smallest;    // size of a point, pixels
uniform float hide_loose;  // 1: not the points on no surface
in vec4 place;             // x, y, z in steps, surface field
in vec2 moment;            // time in steps, scanner
out vec3 colour;

// The signed distance from the surface, and the surface's normal there.
float residual(float field, vec3 p, out vec3 normal) {
  vec4 plane = surface_row(field, 0);
  vec4 cylinder = surface_row(field, 1);
  if (cylinder.w == 0.0) {
    normal = plane.xyz;
    return dot(plane.xyz, p) - plane.w;
  }
  vec2 away = p.xy - cylinder.xy;
  normal = plane.w * vec3(normalize(away), 0.0);
  return plane.w * (length(away) - cylinder.z);
}

void main() {
  vec3 p = origin + step_m * place.xyz;
  float field = place.w;
  vec4 own = surface_row(field, 2);
  if (p.z < heights.x || p.z > heights.y || moment.x < times.x || moment.x > times.y ||
      (field < 2.0 && hide_loose > 0.0) || is_hidden(own, field, p)) {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);  // out of sight
    gl_PointSize = 1.0;
    return;
  }
  float value = p.z;
  colour = own.rgb;
  if (coloured_by == 3) {
    colour = texelFetch(scanners, ivec2(int(moment.y), 0), 0).rgb;
  } else if (coloured_by != 0 && (coloured_by != 4 || field >= 2.0)) {
    if (coloured_by == 2) value = moment.x;
    if (coloured_by == 4) {
      // On the surface: else only those nearest to the eye, with residuals of one sign, would show.
      vec3 normal;
      value = residual(field, p, normal);
      p -= value * normal;
    }
    float share = clamp((value - ramp_ends.x) / (ramp_ends.y - ramp_ends.x), 0.0, 1.0);
    colour = texture(ramp, vec2(share, 0.5)).rgb;
  }
  if (coloured_by != 0) colour = mix(colour, own.rgb, mod(own.a, 2.0));
  vec4 in_view = viewMatrix * vec4(p, 1.0);
  gl_Position = projectionMatrix * in_view;
  gl_PointSize = clamp(point_m * pixels / -in_view.z, smallest, 24.0);
}
`;

export const POINT_FRAGMENT = `
precision mediump float;
in vec3 colour;
out vec4 pixel;
void main() { pixel = vec4(colour, 1.0); }
`;

// Lines and areas on surfaces, drawn a little nearer than they are: points scatter about them. A
// line has a width in pixels: each of its ends is two corners, at either side of it.
export const OVERLAY_VERTEX = `
${VISIBILITY}
uniform float nearer;      // m
uniform float own_colour;  // 1: the surface's
uniform vec3 tint;
uniform vec2 half_screen;  // pixels
uniform float width;       // of lines, pixels; 0 of areas
in vec3 position;
in vec3 other;             // the line's other end
in float side;             // +1 or -1
in float field;
out vec3 colour;
out float height;
out float hidden;

vec4 placed(vec3 p) {
  vec4 in_view = viewMatrix * vec4(p, 1.0);
  in_view.xyz *= max(0.2, 1.0 - nearer / length(in_view.xyz));
  return projectionMatrix * in_view;
}

void main() {
  gl_Position = placed(position);
  if (width > 0.0) {
    vec4 end = placed(other);
    float near = 0.02;
    // Of a line that passes the eye, the part before it.
    float step = end.w - gl_Position.w;
    if (gl_Position.w < near) gl_Position = mix(gl_Position, end, (near - gl_Position.w) / step);
    if (end.w < near) end = mix(end, gl_Position, (end.w - near) / step);
    vec2 along = (end.xy / end.w - gl_Position.xy / gl_Position.w) * half_screen;
    float size = length(along);
    vec2 across = size > 0.0 ? vec2(-along.y, along.x) / size : vec2(0.0);
    gl_Position.xy += 0.5 * width * side * across / half_screen * gl_Position.w;
  }
  vec4 own = surface_row(field, 2);
  hidden = is_hidden(own, field, position) ? 1.0 : 0.0;
  height = position.z;
  colour = mix(tint, 0.8 * own.rgb, own_colour);
}
`;

export const OVERLAY_FRAGMENT = `
precision highp float;
uniform vec2 heights;
uniform float opacity;
in vec3 colour;
in float height;
in float hidden;
out vec4 pixel;
void main() {
  if (hidden > 0.5 || height < heights.x - 0.01 || height > heights.y + 0.01) discard;
  pixel = vec4(colour, opacity);
}
`;

export const COMPOSE_VERTEX = `
in vec3 position;
void main() { gl_Position = vec4(position.xy, 0.0, 1.0); }
`;

// Copies what was drawn of the points, darker where neighbours are nearer (eye-dome lighting,
// Boucheny 2009), so that edges show.
export const COMPOSE_FRAGMENT = `
precision highp float;
precision highp sampler2D;
uniform sampler2D colours;
uniform sampler2D depths;
uniform vec3 ground;
uniform vec2 near_far;
uniform float strength;
uniform int radius;
out vec4 pixel;

float log_distance(float depth) {
  return log2(near_far.x * near_far.y / (near_far.y - depth * (near_far.y - near_far.x)));
}

void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  float depth = texelFetch(depths, at, 0).r;
  gl_FragDepth = depth;
  ivec2 last = textureSize(depths, 0) - 1;
  float own = depth < 1.0 ? log_distance(depth) : 0.0;
  float shade = 0.0;
  if (depth < 1.0) {
    for (int i = 0; i < 4; ++i) {
      ivec2 offset = radius * ivec2(i < 2 ? 2 * i - 1 : 0, i < 2 ? 0 : 2 * i - 5);
      float other = texelFetch(depths, clamp(at + offset, ivec2(0), last), 0).r;
      if (other < 1.0) shade += max(0.0, own - log_distance(other));
    }
  }
  vec3 colour = depth < 1.0 ? texelFetch(colours, at, 0).rgb : ground;
  pixel = vec4(colour * exp(-strength * min(shade, 0.12)), 1.0);
}
`;
