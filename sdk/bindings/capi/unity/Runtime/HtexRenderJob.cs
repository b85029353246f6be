// Voices in jobs of Unity, with and without Burst: only numbers and pointers are passed to the library.
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
    /// A voice in a job. It does not hold the Voice: dispose of that after the job is complete. A call with one that is disposed of returns
    /// BadHandle, one during another call Busy.
    /// </summary>
    public struct HtexVoice
    {
        private readonly ulong id;

        public HtexVoice(Voice voice)
        {
            id = voice.Id;
        }

        /// <summary>Sets the motion of the finger; spectrum and level glide to it.</summary>
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

        /// <summary>Adds the next samples, multiplied by a gain.</summary>
        public unsafe Status RenderAdd(NativeArray<float> samples, float gain)
        {
            return (Status)htex_voice_render_add(id, (float*)NativeArrayUnsafeUtility.GetUnsafePtr(samples), (UIntPtr)(uint)samples.Length, gain);
        }

        // Burst passes neither objects nor enums, and structs only by pointer; a handle of htex.h has one field, and is passed as that.
        [DllImport(Native.Library)] private static extern unsafe int htex_voice_set_motion(ulong voice, Motion* motion);
        [DllImport(Native.Library)] private static extern unsafe int htex_voice_render(ulong voice, float* samples, UIntPtr frames);
        [DllImport(Native.Library)] private static extern unsafe int htex_voice_render_add(ulong voice, float* samples, UIntPtr frames, float gain);
    }

    /// <summary>Renders a block of a voice at a motion. Burst compiles it if its package is there.</summary>
#if HTEX_BURST
    [Unity.Burst.BurstCompile]
#endif
    public struct HtexRenderJob : IJob
    {
        public HtexVoice Voice;
        public Motion Motion;
        /// <summary>Receives the samples, in the asset's unit.</summary>
        [WriteOnly] public NativeArray<float> Samples;
        /// <summary>Receives the status as its one number; 0 is Ok.</summary>
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
