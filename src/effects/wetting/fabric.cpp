#include "oilskin/wetting.h"

#include "core/refuse.h"

namespace oilskin {

Status Fabric::validate() const {
  if (!within(capacity, 1e-6, 1e3)) return refuse_value("fabric.capacity", capacity, "1e-6 … 1e3 kg/m²");
  if (!within(diffusivity, 1e-15, 1))
    return refuse_value("fabric.diffusivity", diffusivity, "1e-15 … 1 m²/s");
  if (!within(mobility_exponent, 0, 10))
    return refuse_value("fabric.mobility_exponent", mobility_exponent, "0 … 10");
  if (!(capillary_rise >= 1e-6)) return refuse_value("fabric.capillary_rise", capillary_rise, "≥ 1e-6 m");
  if (!within(anisotropy, 1e-3, 1e3)) return refuse_value("fabric.anisotropy", anisotropy, "1e-3 … 1e3");
  if (!within(warp.norm(), 1e-9, 1e9))
    return refuse_value("fabric.warp", warp.transpose(), "of length 1e-9 … 1e9");
  if (!within(saturation_limit, 1, 10))
    return refuse_value("fabric.saturation_limit", saturation_limit, "1 … 10");
  return {};
}

Fabric cotton_fabric() {
  Fabric f;
  f.capacity = 0.3;
  f.diffusivity = 1e-5;
  f.mobility_exponent = 2;
  f.capillary_rise = 0.12;
  return f;
}

Fabric wool_fabric() {
  Fabric f;
  f.capacity = 0.6;
  f.diffusivity = 1e-6;
  f.mobility_exponent = 3;
  f.capillary_rise = 0.04;
  return f;
}

Fabric nylon_fabric() {
  Fabric f;
  f.capacity = 0.11;
  f.diffusivity = 5e-6;
  f.mobility_exponent = 2;
  f.capillary_rise = 0.06;
  return f;
}

}  // namespace oilskin
