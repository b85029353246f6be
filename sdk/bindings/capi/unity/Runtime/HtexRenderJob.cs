// Renders voices in Unity jobs, with and without Burst. The calls pass only numbers and pointers to
// libhtex.
//
// SPDX-License-Identifier: MIT OR Apache-2.0
#if UNITY_2021_2_OR_NEWER
using System;
using System.Runtime.InteropServices;
using Unity.Collections;
using Unity.Collections.LowLevel.Unsafe;
using Unity.Jobs;

namespace Htex
{
    /// <summary>
    /// Refers to a Voice in a Unity job. It does not keep the Voice alive, so dispose of the Voice
    /// only after the job is complete. If the Voice was disposed of, calls return BadHandle. If
    /// another call is using the Voice, they return Busy.
    /// </summary>
    public struct HtexVoice
    {
        private readonly ulong id;

        public HtexVoice(Voice voice)
        {
            id = voice.Id;
        }

        /// <summary>
        /// Sets the motion of the finger. Spectrum and level change gradually to the new motion.
        /// </summary>
        public unsafe Status SetMotion(Motion motion)
        {
            motion.Size = (uint)sizeof(Motion);
            return (Status)htex_voice_set_motion(id, &motion);
        }

        /// <summary>Renders the next samples, in the asset's unit.</summary>
        public unsafe Status Render(NativeArray<float> samples)
        {
            return (Status)htex_voice_render(id, (float*)NativeArrayUnsafeUtility.GetUnsafePtr(samples), (UIntPtr)(uint)samples.Length);
        }

        /// <summary>
        /// Renders the next samples, multiplies them by a gain and adds them to the array.
        /// </summary>
        public unsafe Status RenderAdd(NativeArray<float> samples, float gain)
        {
            return (Status)htex_voice_render_add(id, (float*)NativeArrayUnsafeUtility.GetUnsafePtr(samples), (UIntPtr)(uint)samples.Length, gain);
        }

        // Burst can pass neither objects nor enums, and structs only by pointer. A handle of htex.h
        // has a single field, so these functions pass that field.
        [DllImport(Native.Library)] private static extern unsafe int htex_voice_set_motion(ulong voice, Motion* motion);
        [DllImport(Native.Library)] private static extern unsafe int htex_voice_render(ulong voice, float* samples, UIntPtr frames);
        [DllImport(Native.Library)] private static extern unsafe int htex_voice_render_add(ulong voice, float* samples, UIntPtr frames, float gain);
    }

    /// <summary>
    /// Sets the motion of a voice and renders one block. Burst compiles the job if the Burst
    /// package is installed.
    /// </summary>
#if HTEX_BURST
    [Unity.Burst.BurstCompile]
#endif
    public struct HtexRenderJob : IJob
    {
        public HtexVoice Voice;
        public Motion Motion;
        /// <summary>Receives the samples, in the asset's unit.</summary>
        [WriteOnly] public NativeArray<float> Samples;
        /// <summary>Receives the status as its only element; 0 is Ok.</summary>
        [WriteOnly] public NativeArray<int> Result;

        public void Execute()
        {
            Status status = Voice.SetMotion(Motion);
            if (status == Status.Ok)
                status = Voice.Render(Samples);
            Result[0] = (int)status;
        }
    }
}
#endif
