// The SpaceMouse family by its USB numbers.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace asperity {

struct spacemouse_product {
  std::uint16_t vendor_id = 0;
  std::uint16_t product_id = 0;
  std::string_view name;
};

/// Products with six axes. Logitech's vendor number is that of the older ones.
/// Left out because they have no six axes: CadMouse (c650, c651, c654-c658) and the keyboards (c664, c665, c668).
/// Left out because public sources disagree about it: c641.
/// @source PySpaceMouse's list of devices; spacenavd's and VRPN's, as facts
inline constexpr std::array spacemouse_products{
    spacemouse_product{0x046d, 0xc603, "SpaceMouse Plus XT"},
    spacemouse_product{0x046d, 0xc605, "CadMan"},
    spacemouse_product{0x046d, 0xc606, "SpaceMouse Classic"},
    spacemouse_product{0x046d, 0xc621, "Spaceball 5000"},
    spacemouse_product{0x046d, 0xc623, "SpaceTraveler"},
    spacemouse_product{0x046d, 0xc625, "SpacePilot"},
    spacemouse_product{0x046d, 0xc626, "SpaceNavigator"},
    spacemouse_product{0x046d, 0xc627, "SpaceExplorer"},
    spacemouse_product{0x046d, 0xc628, "SpaceNavigator for Notebooks"},
    spacemouse_product{0x046d, 0xc629, "SpacePilot Pro"},
    spacemouse_product{0x046d, 0xc62b, "SpaceMouse Pro"},
    spacemouse_product{0x256f, 0xc62e, "SpaceMouse Wireless, on its cable"},
    spacemouse_product{0x256f, 0xc62f, "SpaceMouse Wireless, its receiver"},
    spacemouse_product{0x256f, 0xc631, "SpaceMouse Pro Wireless, on its cable"},
    spacemouse_product{0x256f, 0xc632, "SpaceMouse Pro Wireless, its receiver"},
    spacemouse_product{0x256f, 0xc633, "SpaceMouse Enterprise"},
    spacemouse_product{0x256f, 0xc635, "SpaceMouse Compact"},
    spacemouse_product{0x256f, 0xc636, "SpaceMouse Module"},
    spacemouse_product{0x256f, 0xc638, "SpaceMouse Pro Wireless, over Bluetooth"},
    spacemouse_product{0x256f, 0xc63a, "SpaceMouse Wireless, over Bluetooth"},
    spacemouse_product{0x256f, 0xc652, "3Dconnexion Universal Receiver"},
};

/// The product, or null where it is not one of the family.
[[nodiscard]] constexpr const spacemouse_product* find_spacemouse(std::uint16_t vendor_id,
                                                                  std::uint16_t product_id) noexcept {
  for (const spacemouse_product& p : spacemouse_products) {
    if (p.vendor_id == vendor_id && p.product_id == product_id) return &p;
  }
  return nullptr;
}

}  // namespace asperity
