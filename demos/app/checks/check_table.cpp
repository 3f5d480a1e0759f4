#include "checks/check_table.h"

namespace oilskin::demo {

// Each in the file of its name.
std::unique_ptr<Check> make_crossings();
std::unique_ptr<Check> make_not_finite();
std::unique_ptr<Check> make_surfaces_left_out();
std::unique_ptr<Check> make_momentum_residual();
std::unique_ptr<Check> make_mass_residual();
std::unique_ptr<Check> make_divergence();
std::unique_ptr<Check> make_min_emitted();
std::unique_ptr<Check> make_min_over_rim();
std::unique_ptr<Check> make_vertical_momentum();
std::unique_ptr<Check> make_sag_below_dry();
std::unique_ptr<Check> make_max_stretch();
std::unique_ptr<Check> make_slip_ratio();
std::unique_ptr<Check> make_pin_reaction();
std::unique_ptr<Check> make_dry_shadow();
std::unique_ptr<Check> make_pool_level();
std::unique_ptr<Check> make_pool_calm();
std::unique_ptr<Check> make_at_rest();
std::unique_ptr<Check> make_dam_break();
std::unique_ptr<Check> make_inside_constant();
std::unique_ptr<Check> make_enclosed_volume();
std::unique_ptr<Check> make_energy_decay();
std::unique_ptr<Check> make_close_layers();
std::unique_ptr<Check> make_memory_growth();
std::unique_ptr<Check> make_water_meshes();
std::unique_ptr<Check> make_wetting();
std::unique_ptr<Check> make_floats();
std::unique_ptr<Check> make_drained();

Span<const CheckEntry> check_table() {
  static const CheckEntry table[] = {
      {nullptr, make_crossings},
      {nullptr, make_not_finite},
      {nullptr, make_surfaces_left_out},
      {nullptr, make_momentum_residual},
      {nullptr, make_mass_residual},
      {nullptr, make_divergence},
      {"min_emitted", make_min_emitted},
      {"min_over_rim", make_min_over_rim},
      {"vertical_momentum", make_vertical_momentum},
      {"sag_below_dry", make_sag_below_dry},
      {"max_stretch", make_max_stretch},
      {"slip_ratio", make_slip_ratio},
      {"pin_reaction", make_pin_reaction},
      {"dry_shadow", make_dry_shadow},
      {"pool_level", make_pool_level},
      {"pool_calm", make_pool_calm},
      {nullptr, make_at_rest},
      {"dam_break", make_dam_break},
      {"inside_constant", make_inside_constant},
      {"enclosed_volume", make_enclosed_volume},
      {"energy_decay", make_energy_decay},
      {"close_layers", make_close_layers},
      {"memory_growth", make_memory_growth},
      {"wetting", make_wetting},
      {"floats", make_floats},
      {"drained", make_drained},
      {nullptr, make_water_meshes},
  };
  return table;
}

}  // namespace oilskin::demo
