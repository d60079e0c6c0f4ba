// The C interface from C#, with Unity's axes: x right, y up, z forward, left-handed. What stands in `Asperity` a script of
// an engine can take as it is; Program stands for the engine, which calls FixedUpdate().
//
//     mcs -unsafe 08_game_loop.cs && LD_LIBRARY_PATH=LIB mono 08_game_loop.exe PROBE.glb FIXED.glb
using System;
using System.Runtime.InteropServices;

static class Asperity {
  const string library = "asperity_c";

  [StructLayout(LayoutKind.Sequential)]
  public struct Error {
    public uint size;
    public int code;
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = 504)]
    public byte[] message;

    public static Error Empty() { return new Error { size = 512, message = new byte[504] }; }
    public override string ToString() {
      return System.Text.Encoding.UTF8.GetString(message, 0, Math.Max(0, Array.IndexOf(message, (byte)0)));
    }
  }

  [StructLayout(LayoutKind.Sequential)]
  public struct ToolSettings {
    public uint size, substeps;
    public double period_s, mass_kg, coupling_n_per_m, coupling_n_m_per_rad, stiffness_n_per_m, dissipation_s_per_m,
        static_friction, dynamic_friction, most_force_n, most_torque_n_m;
    [MarshalAs(UnmanagedType.ByValArray, SizeConst = 7)]
    public double[] probe_on_hand;
  }

  // Blittable, so that no call allocates: the arrays are fields.
  [StructLayout(LayoutKind.Sequential)]
  public unsafe struct Felt {
    public uint size, flags;
    public int contact_answer;
    public uint contacts;
    public fixed double on_hand[6];
    public fixed double on_probe[6];
    public fixed double probe_pose[7];
    public double deepest_m;
  }

  [DllImport(library)] public static extern IntPtr asperity_version();
  [DllImport(library)] public static extern int asperity_model_load(byte[] file, out IntPtr model, ref Error why);
  [DllImport(library)] public static extern int asperity_model_free(IntPtr model);
  [DllImport(library)]
  public static extern int asperity_tool_make(IntPtr probe, IntPtr[] fixed_bodies, uint count, ref ToolSettings settings,
                                              out IntPtr tool, ref Error why);
  [DllImport(library)] public static extern int asperity_tool_free(IntPtr tool);
  [DllImport(library)] public static extern unsafe int asperity_tool_place(IntPtr tool, double* hand);
  [DllImport(library)]
  public static extern unsafe int asperity_tool_follow(IntPtr tool, double* hand, double dt_s, ref Felt felt);
  [DllImport(library)] public static extern unsafe int asperity_pose_from_unity(double* unity, double* pose);
  [DllImport(library)] public static extern unsafe int asperity_pose_to_unity(double* pose, double* unity);
  [DllImport(library)] public static extern unsafe int asperity_wrench_to_unity(double* wrench, double* unity);
}

// A tool that hangs on a hand of the engine.
unsafe class HapticTool : IDisposable {
  IntPtr probe, body, tool;
  Asperity.Felt felt = new Asperity.Felt { size = (uint)sizeof(Asperity.Felt) };

  public HapticTool(string probeFile, string bodyFile, double period) {
    probe = Load(probeFile);
    body = Load(bodyFile);
    var settings = new Asperity.ToolSettings {
      size = (uint)Marshal.SizeOf(typeof(Asperity.ToolSettings)), period_s = period,
      static_friction = 0.4, dynamic_friction = 0.3, most_force_n = 5.0, probe_on_hand = new double[7]
    };
    var why = Asperity.Error.Empty();
    if (Asperity.asperity_tool_make(probe, new[] { body }, 1, ref settings, out tool, ref why) != 0)
      throw new Exception(why.ToString());
  }

  static IntPtr Load(string file) {
    IntPtr model;
    var why = Asperity.Error.Empty();
    var name = System.Text.Encoding.UTF8.GetBytes(file + "\0");
    if (Asperity.asperity_model_load(name, out model, ref why) != 0) throw new Exception(why.ToString());
    return model;
  }

  // Positions and turns as the engine has them.
  public void Place(double* hand) {
    double* pose = stackalloc double[7];
    Asperity.asperity_pose_from_unity(hand, pose);
    Asperity.asperity_tool_place(tool, pose);
  }

  // force: what pulls at the hand, in the engine's axes; tool_pose: where to draw the tool.
  public int FixedUpdate(double* hand, double dt, double* force, double* tool_pose) {
    double* pose = stackalloc double[7];
    Asperity.asperity_pose_from_unity(hand, pose);
    int answer;
    fixed (Asperity.Felt* f = &felt) {
      answer = Asperity.asperity_tool_follow(tool, pose, dt, ref felt);
      Asperity.asperity_wrench_to_unity(f->on_hand, force);
      Asperity.asperity_pose_to_unity(f->probe_pose, tool_pose);
    }
    return answer;
  }

  public void Dispose() {
    Asperity.asperity_tool_free(tool);
    Asperity.asperity_model_free(body);
    Asperity.asperity_model_free(probe);
    tool = body = probe = IntPtr.Zero;
  }
}

static class Program {
  static unsafe int Main(string[] arguments) {
    if (arguments.Length != 2) {
      Console.WriteLine("usage: 08_game_loop.exe PROBE.glb FIXED.glb");
      return 2;
    }
    Console.WriteLine("asperity " + Marshal.PtrToStringAnsi(Asperity.asperity_version()));
    try {
      var broken = new HapticTool("nowhere.glb", arguments[1], 1e-3);
      broken.Dispose();
      return 1;
    } catch (Exception e) {
      Console.WriteLine("refused: " + e.Message);
    }
    const double dt = 1e-3;
    using (var tool = new HapticTool(arguments[0], arguments[1], dt)) {
      double* hand = stackalloc double[7];
      double* force = stackalloc double[6];
      double* drawn = stackalloc double[7];
      for (int i = 0; i < 6; ++i) hand[i] = 0.0;
      hand[6] = 1.0;
      hand[1] = 0.06;  // above the body: up is y
      tool.Place(hand);
      double largest = 0.0;
      for (int i = 0; i < 3000; ++i) {
        if (hand[1] > 0.0 && force[1] < 3.0) hand[1] -= 0.00002;
        if (tool.FixedUpdate(hand, dt, force, drawn) != 0) return 1;
        largest = Math.Max(largest, force[1]);
      }
      Console.WriteLine("the hand felt up to {0:F2} N upwards; the tool is {1:F1} mm above it", largest,
                        1000.0 * (drawn[1] - hand[1]));
      return largest > 1.0 && drawn[1] > hand[1] ? 0 : 1;
    }
  }
}
