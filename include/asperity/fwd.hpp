// The names of the types that a program hands around, without what they are: for headers that only mention them.
#pragma once

namespace asperity {

struct pose;
struct wrench;
struct mat6;
struct textured_model;
struct scene;
struct scene_pose;
struct tick;
struct contact;
class contact_set;
struct penetration;
struct support_plane;

struct renderer_settings;
struct field_renderer_settings;
struct paper_settings;
class any_depth;

struct control_config;
class any_device;
struct device_state;
struct capabilities;

}  // namespace asperity
