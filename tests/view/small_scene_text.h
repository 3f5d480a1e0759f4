// A cloth over a box, water above both: small enough for tests that take many steps.
#pragma once

namespace oilskin::test {

constexpr const char* small_scene_text = R"({
  "name": "small", "dt": 0.002, "duration": 1,
  "fluid": { "spacing": 0.01 },
  "emitters": [ { "shape": "box", "min": [-0.03, 0.03, -0.03], "max": [0.03, 0.06, 0.03] } ],
  "cloth": [ { "grid": [13, 13], "size": [0.24, 0.24], "pins": "corners", "areal_density": 0.5, "thickness": 0.002 } ],
  "bodies": [ { "shape": "box", "center": [0, -0.3, 0], "half_extents": [0.3, 0.02, 0.3], "thickness": 0.002 } ],
  "contact": { "verify": true },
  "kill_box": { "min": [-1, -1, -1], "max": [1, 1, 1] },
  "pictures": { "views": [ { "eye": [0.3, 0.4, 0.5], "target": [0, 0, 0] }, { "eye": [0, 1, 0.1], "target": [0, 0, 0] } ] }
})";

}  // namespace oilskin::test
