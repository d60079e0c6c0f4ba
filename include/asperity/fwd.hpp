// Names of the types that a program hands around, without what they are: for headers that only mention them.
#pragma once

namespace asperity {

struct pose;
struct wrench;
struct scene;
struct scene_pose;
struct placed_scene;
struct body_handle;
struct textured_model;
struct field_body;

struct tick;
struct contact;
class contact_set;
struct penetration;
struct support_plane;

struct least_motion_renderer_settings;
struct plane_renderer_settings;
struct plane_scene;
class scene_editor;
struct window_renderer_settings;
class any_renderer;
class any_depth;

struct control_settings;
struct device_capabilities;
class any_device;

}  // namespace asperity
